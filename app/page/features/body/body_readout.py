"""Tables of a body's run on the page."""

from html import escape

from app.frame.body_sentences import estimate_rows, goal_rows
from app.frame.shown_body import ShownBody
from app.language.translation import tr, translate_message
from app.names_and_units import with_unit
from app.page.panels.readout_tables import ReadoutTables, row_html, table_html


def body_readout(body: ShownBody, k: int) -> ReadoutTables:
    """Returns tables of a body's goals and estimates, and of its run."""
    tables = [table_html("".join(row_html("head" * (not k), *map(escape, texts)) for k, texts in enumerate(rows)),
                         "lab-numbers lab-estimates")
              for rows in ([(*texts, "") for texts in goal_rows(body)], estimate_rows(body))]
    notes = "".join(f"<p>{escape(text[:1].upper() + text[1:])}.</p>" for text in map(translate_message, (
        *body.warnings, *body.remarks)))
    about = [(tr("body"), escape(body.source.name)), (tr("time"), with_unit(body.times[k], "s")),
             (tr("particles"), f"{body.particles:,}"), (tr("grid"), f"h = {with_unit(body.spacing, 'm')}")]
    run = table_html("".join(f"<tr><td>{name}</td>\n<td>{text}</td></tr>\n" for name, text in about))
    return ReadoutTables("".join(tables) + f"<div class='lab-own'>{notes}</div>", run)
