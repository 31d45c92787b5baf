"""Bets of a visitor and of judges, beside the truth, as html."""

from collections.abc import Sequence
from html import escape

from app.lessons.bet_lines import Lines, drawn
from app.lessons.bets import Bettor

WAITED_FOR = "Bets are being laid beside the truth …"
ROW, OWN_ROW = 7, 12  # pixels from a line to the next: of a judge, of the visitor


def bets_html(bettors: Sequence[Bettor] | str) -> str:
    """The picture, or the sentence that stands in its place; "" of nobody."""
    if isinstance(bettors, str):
        return f"<p class='lab-bets-later'>{escape(bettors)}</p>"
    if not bettors:
        return ""
    picture = drawn(bettors)
    rows = "".join(map(_row, picture.bettors))
    axis = "".join(f"<span>{text}</span>" for _, text in picture.ticks)
    return f"<figure class='lab-bets'><figcaption>{picture.said}</figcaption>{rows}" \
           f"<div class='lab-bets-axis' aria-hidden='true'>{axis}</div></figure>"


def _row(bettor: Lines) -> str:
    """One bettor: who, how it went, and the lines."""
    high = OWN_ROW if bettor.own else ROW
    lines = "".join(_line(line, (k + 0.5) * high) for k, line in enumerate(bettor.lines) if line)
    label = escape(f"{bettor.name}: {bettor.told}", quote=True)
    return f"<div class='lab-bettor'><b>{escape(bettor.name)}</b> <span>{escape(bettor.told)}</span>" \
           f"<svg role='img' aria-label='{label}' height='{high * len(bettor.lines)}'>" \
           f"<line class='lab-bets-truth' x1='50%' x2='50%' y1='0' y2='100%'/>{lines}</svg></div>"


def _line(line: tuple[float, float, bool], y: float) -> str:
    low, high, holds = line
    kind = "lab-held" if holds else "lab-missed"
    return f"<line class='{kind}' x1='{low:.2f}%' x2='{high:.2f}%' y1='{y:g}' y2='{y:g}'/>"
