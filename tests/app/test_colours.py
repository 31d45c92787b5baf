"""The palette: enough contrast for whoever reads it, and the same on the page, in pictures and with the estimators."""

from __future__ import annotations

import re
from itertools import combinations, pairwise, product
from pathlib import Path

import numpy as np
import pytest
from matplotlib import colormaps

from app import colour_palette
from app.colour_palette import GROUNDS, LINES, PALETTE, TEXTS, rgb
from solvers.problems import PROBLEMS
from solvers.scene.error_causes import CAUSES
from solvers.scene.estimator_registry import ESTIMATORS

TOKENS = Path(colour_palette.__file__).parent / "page" / "web" / "css" / "00-tokens.css"
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
    assert all(contrast(colour, "#ffffff") >= 3 for colour in (*colour_palette.METHOD_COLOURS.values(),
                                                               colour_palette.PINNED))


#: What people see who lack one kind of cone, of linear red, green and blue (Machado, Oliveira & Fernandes 2009).
BLINDNESS = {
    "none": np.eye(3),
    "protanopia": np.array([[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
                            [-0.003882, -0.048116, 1.051998]]),
    "deuteranopia": np.array([[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
                              [-0.011820, 0.042940, 0.968881]]),
    "tritanopia": np.array([[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602],
                            [0.004733, 0.691367, 0.303900]])}


def lightness_and_hue(colour: str, seen: np.ndarray) -> np.ndarray:
    """L*, a*, b* of CIE 1976 under D65, as somebody sees it."""
    parts = np.array(rgb(colour)) / 255
    linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]) \
        @ np.clip(seen @ linear, 0, 1) / np.array([0.9505, 1.0, 1.089])
    x, y, z = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.parametrize("shade", (0, 1), ids=("light", "dark"))
@pytest.mark.parametrize("blindness", BLINDNESS)
def test_causes_are_told_apart(shade, blindness):
    """Areas side by side, and the ground: 20 in L*a*b*, where 2 can just be seen."""
    assert list(colour_palette.CAUSES) == list(CAUSES)
    several = [*(both[shade] for both in colour_palette.CAUSES.values()), GROUNDS["ground"][shade]]
    seen = [lightness_and_hue(colour, BLINDNESS[blindness]) for colour in several]
    assert min(np.linalg.norm(one - other) for one, other in combinations(seen, 2)) >= 20


def test_the_page_has_the_same_palette():
    light, dark = re.findall(r":root[^{]*\{(\s*color-scheme.*?)\}", TOKENS.read_text(encoding="utf-8"), re.S)
    for shade, rules in enumerate((light, dark)):
        said = dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6});", rules))
        wanted = PALETTE | {colour_palette.cause_css_variable(cause): both for cause,
                            both in colour_palette.CAUSES.items()}
        assert {name: said.get(name) for name in wanted} == {name: both[shade] for name, both in wanted.items()}
        if not shade:
            assert dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6});",
                                   colour_palette.css_variables())).items() <= said.items()


def test_estimators_have_colours_of_the_palette_and_dashes_of_their_own():
    assert {name: ESTIMATORS[name].colour.lower() for name in OURS} \
        == {name: LINES[name.replace("-", "")].light for name in OURS}
    assert len({ESTIMATORS[name].dashes for name in OURS}) == len(OURS)


def test_estimate_truth_and_estimators_are_told_apart_by_lightness_too():
    assert contrast(colour_palette.ESTIMATE, colour_palette.TRUTH) > 1.25
    for problem in PROBLEMS.values():
        shades = sorted((ESTIMATORS[name].colour for name in problem.estimators), key=_luminance)
        assert all(contrast(*pair) > 1.25 for pair in pairwise(shades))


def test_the_colour_map_rises_evenly_in_lightness():
    table = colour_palette.colour_table()
    assert table.shape == (256, 3) and table.dtype == np.uint8 and colour_palette.COLOUR_MAP == "viridis"
    assert np.array_equal(table, (255 * colormaps[colour_palette.COLOUR_MAP](np.arange(256))[:, :3]).round())
    lightness = np.cbrt([_luminance(f"#{shade.tobytes().hex()}") for shade in table[::15]])
    steps = np.diff(lightness)
    assert np.all(steps > 0) and steps.max() < 2 * steps.min()
