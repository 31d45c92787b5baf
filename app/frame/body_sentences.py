"""What the page says of a body: headline, title and tables."""

import math

from app.frame.headline import HeadlineWithFacts, root_mean_square, to_spans
from app.frame.primitives import SEPARATOR, Spans
from app.frame.shown_body import ShownBody
from app.frame.value_and_bar import value_and_bar
from app.language.translation import lazy, localise_number, tr, translate_message
from app.names_and_units import NOTHING, QUANTITIES, clock_text, format_coordinates, functions_name, with_unit
from solvers.bodies.estimate import QUANTITIES as UNITS

#: Headlines by what a goal asks for; the places are its name, point, component of stress and, emphasised, value.
SENTENCES = {
    "min x": lazy("{goal}: ({at}) moves back to x = {wrong}"), "max x": lazy("{goal}: ({at}) moves to x = {wrong}"),
    "min y": lazy("{goal}: ({at}) sinks to y = {wrong}"), "max y": lazy("{goal}: ({at}) rises to y = {wrong}"),
    "end x": lazy("{goal}: ({at}) ends at x = {wrong}"), "end y": lazy("{goal}: ({at}) ends at y = {wrong}"),
    "time of return x": lazy("{goal}: ({at}) is back after {wrong}"),
    "time of return y": lazy("{goal}: ({at}) is back after {wrong}")}
STRESS = lazy("{goal}: at ({at}) the size of σ {axis} is {wrong} at most")
NOBODY = lazy("nobody knows the exact motion; two companions, finer solves beside the run, stand in for it")
TRUST = {"number": lazy("a number"), "30 %": lazy("± 30 %"), "none": lazy("no number: take finer elements")}


def body_headline(body: ShownBody) -> HeadlineWithFacts:
    """Returns the headline on a body: its first goal, so far or of the whole run, with its bar."""
    name = next(iter(body.goals), None)
    found = body.goal_value(name) if name else None
    result = body.result
    if result is not None and result["status"] != "ok":
        return HeadlineWithFacts((("bad", tr("the run of {body} has ended: {reason}", body=body.source.name,
                                             reason=translate_message(result["reason"]))),), (), "unstable")
    facts = [*map(translate_message, body.remarks), tr(NOBODY)]
    if name is None or found is None or found.value is None:
        said = tr("the body {body} is on the stage", body=body.source.name) if name is None or result is None else \
            tr("{goal} is not reached by the end", goal=name)
        return HeadlineWithFacts(((("", said)),), tuple(facts), result is None)
    goal = body.goals[name]
    value, bar = value_and_bar(found.value, found.bar, found.unit)
    text = tr(STRESS if goal.is_stress else SENTENCES[goal.value])
    text += ", ± {share}" if bar else tr(", without a bar: no estimate after t = {until}") if body.estimate_ended else \
        tr(" (no bar)")
    text += "" if result is not None else tr(", so far")
    at = format_coordinates(goal.at).replace("-", "−")
    places = {"goal": name, "axis": goal.parts[1], "at": at, "wrong": value, "share": bar,
              "until": clock_text(body.estimated_until)}
    return HeadlineWithFacts(tuple(to_spans(text, places)), tuple(facts),
                             (result is None, body.estimate_ended))


def body_name(body: ShownBody) -> Spans:
    """Returns the name of a body's run, for its title."""
    settings = tr("{cells:g} cells a metre, {ppc} × {ppc} a cell", cells=body.body["cells_per_metre"],
                  ppc=body.body["ppc"])
    return ("what", f"{body.source.name}: "), ("", functions_name(body.body["method"])), ("settings", f" {settings}")


def body_facts(body: ShownBody, k: int, quantity: str) -> Spans:
    """Returns what the title says of the estimate in frame ``k``: its size, and whether to believe it."""
    if body.estimated_until < body.times[k]:
        return (("", tr("no estimate after t = {until}", until=clock_text(body.estimated_until))),)
    trust = body.trust(quantity)
    sizes = body.error_sizes(k, quantity)
    size = root_mean_square(sizes)
    reliability = (("", tr("being computed") if trust is None else
                    f"δ = {localise_number(f'{trust[0]:.2f}')}: {tr(TRUST[trust[1]])}"),)
    if (trust and trust[1] == "none") or not math.isfinite(size):
        return reliability
    return (*to_spans(tr("estimated error {wrong}"), {"wrong": with_unit(size, QUANTITIES[quantity].unit, 2)}),
            SEPARATOR, *reliability)


def goal_rows(body: ShownBody) -> list[tuple[str, str, str]]:
    """Returns the table of a body's goals: name, value and error bar, below their headings."""
    rows = [(tr("goal"), tr("value"), tr("error bar"))]
    for name in body.goals:
        found = body.goal_value(name)
        value, bar = (NOTHING, "") if found is None or found.value is None else \
            value_and_bar(found.value, found.bar, found.unit)
        rows.append((name, value, bar and f"± {bar}"))
    return rows


def estimate_rows(body: ShownBody) -> list[tuple[str, str, str, str]]:
    """Returns the table of a body's estimates: quantity, size, delta and how far to believe it, below their
    headings."""
    when = tr("at t = {until}", until=clock_text(body.estimated_until)) if body.estimate_ended else tr("at the end")
    rows = [(tr("estimated error"), when, "δ", "")]
    for key, unit in UNITS.items():
        one = (body.result or {}).get("estimate", {}).get(key)
        rows.append((QUANTITIES[key].symbol, *((NOTHING, NOTHING, "") if one is None else (
            NOTHING if one["final"] is None else with_unit(one["final"], unit, 2),
            localise_number(f"{one['delta']:.2f}"), tr(TRUST[one["trust"]])))))
    return rows
