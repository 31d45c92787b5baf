"""The palette: enough contrast for whoever reads it, and the same on the page, in pictures and with the estimators."""

from __future__ import annotations

import re
from itertools import product
from pathlib import Path

import pytest

from app import colours
from app.colours import GROUNDS, LINES, PALETTE, TEXTS, rgb
from solvers.scene.registry import ESTIMATORS

TOKENS = Path(colours.__file__).parent / "page" / "web" / "css" / "00-tokens.css"
OURS = ("transport", "recovered", "companion", "two-grid")


def contrast(one: str, other: str) -> float:
    """How far apart two colours are in luminance, 1 to 21 (WCAG 2.2)."""
    low, high = sorted(_luminance(colour) for colour in (one, other))
    return (high + 0.05) / (low + 0.05)


def _luminance(colour: str) -> float:
    parts = [part / 255 for part in rgb(colour)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def test_contrast_is_the_guidelines():
    assert contrast("#ffffff", "#000000") == pytest.approx(21)
    assert contrast("#777777", "#ffffff") == contrast("#ffffff", "#777777") == pytest.approx(4.478, abs=1e-3)


@pytest.mark.parametrize("shade", (0, 1), ids=("light", "dark"))
def test_words_and_lines_stand_out_from_every_ground(shade):
    for least, tokens in ((4.5, TEXTS), (3.0, LINES)):
        weak = {(name, ground) for (name, one), (ground, under) in product(tokens.items(), GROUNDS.items())
                if contrast(one[shade], under[shade]) < least}
        assert not weak


def test_methods_stand_out_from_white():
    assert all(contrast(colour, "#ffffff") >= 3 for colour in (*colours.METHOD_COLOURS.values(), colours.PINNED))


def test_the_page_has_the_same_palette():
    light, dark = re.findall(r":root[^{]*\{(\s*color-scheme.*?)\}", TOKENS.read_text(encoding="utf-8"), re.S)
    for shade, rules in enumerate((light, dark)):
        said = dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6});", rules))
        assert {name: said.get(name) for name in PALETTE} == {name: both[shade] for name, both in PALETTE.items()}


def test_estimators_have_colours_of_the_palette_and_dashes_of_their_own():
    assert {name: ESTIMATORS[name].colour.lower() for name in OURS} \
        == {name: LINES[name.replace("-", "")].light for name in OURS}
    assert len({ESTIMATORS[name].dashes for name in OURS}) == len(OURS)
