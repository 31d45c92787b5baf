"""Type and axes of the pictures: the page's own type, sizes as people say them, names that do not lie on each other."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib import font_manager
from matplotlib.figure import Figure

from app.logo_and_font import FONTS
from app.names_and_units import PREFIXES, QUANTITIES, SUPERSCRIPTS
from app.renderers.picture_style import FAMILY, format_size_axis, label_curve_ends


def drawn(low: float, high: float, scale: str = "linear"):
    figure = Figure(layout="constrained")
    axes = figure.subplots()
    axes.plot([0, 1], [low, high])
    axes.set(yscale=scale, ylim=(low, high))
    return figure, axes


def said(figure, axes) -> list[str]:
    figure.canvas.draw()
    low, high = axes.get_ylim()
    return [label.get_text() for label in axes.get_yticklabels() if low <= label.get_position()[1] <= high]


def test_type_is_in_the_package_and_has_every_letter_that_is_written():
    letters = "".join((*PREFIXES.values(), *SUPERSCRIPTS.values(), *map(str, QUANTITIES.values()), "–×−°²✓·≤≥…"))
    for weight in ("normal", "bold"):
        wanted = font_manager.FontProperties(family=FAMILY, weight=weight)
        path = font_manager.findfont(wanted, fallback_to_default=False)
        assert path.startswith(str(FONTS))
        there = font_manager.get_font(path).get_charmap()
        assert not [letter for letter in letters if ord(letter) not in there]
    assert sum(path.stat().st_size for path in FONTS.glob("*.otf")) < 120_000


@pytest.mark.parametrize("low, high, expected", [
    (0.0, 2.6e-4, ["0", "100", "200 µm"]), (-0.03, 0.03, ["−20", "0", "20 mm"]), (0.0, 1.3, ["0", "0.5", "1 m"])])
def test_a_linear_axis_has_one_prefix_and_its_unit_at_the_top(low, high, expected):
    figure, axes = drawn(low, high)
    format_size_axis(axes.yaxis, "m")
    assert said(figure, axes) == expected


@pytest.mark.parametrize("low, high, expected", [
    (3e-6, 4e-3, ["10 µm", "100 µm", "1 mm"]), (4e3, 6e4, ["5 km", "10 km", "20 km", "50 km"])])
def test_a_logarithmic_axis_has_a_unit_at_each_tick(low, high, expected):
    figure, axes = drawn(low, high, "log")
    format_size_axis(axes.yaxis, "m")
    assert said(figure, axes) == expected


def test_names_at_the_ends_of_curves_keep_apart_and_in_order():
    _, axes = drawn(0.0, 1.0)
    same = np.array([0.1, 0.5, np.nan])
    label_curve_ends(axes,
                     [("a", same, "k"), ("b", same + 0.01, "k"), ("c", same + 0.02, "k"), ("none", same * np.nan, "k")],
                     apart=0.1)
    heights = [text.get_position()[1] for text in axes.texts]
    assert [text.get_text() for text in axes.texts] == ["a", "b", "c"]
    assert np.diff(heights) == pytest.approx(0.1, abs=2e-3) and np.mean(heights) == pytest.approx(0.51, abs=1e-3)
