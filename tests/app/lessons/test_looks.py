"""What a lesson shows: letters of figures that can be read beside the stage, no estimate that its text never names."""

from __future__ import annotations

import re

import pytest

from app import state
from app.lessons.lesson import EXPLAIN, filled
from app.lessons.shelf import lessons, names
from solvers.scene.registry import ESTIMATORS
from tests.paths import LESSONS

BESIDE = 400  # pixels of a figure in a window of 1280
LEAST = 11  # pixels of letters
FIGURES = sorted((LESSONS / "figures").glob("*.svg"))


@pytest.mark.parametrize("figure", FIGURES, ids=lambda path: path.stem)
def test_letters_of_a_figure_can_be_read_beside_the_stage(figure):
    text = figure.read_text(encoding="utf-8")
    width = float(re.search(r'viewBox="0 0 ([\d.]+)', text)[1])
    sizes = [float(size) for size in re.findall(r'font-size="([\d.]+)"', text)]
    assert sizes and min(sizes) * BESIDE / width >= LEAST


@pytest.mark.parametrize("name", names())
def test_an_estimate_is_on_the_stage_only_where_the_text_speaks_of_it(name):
    """In one of the steps until it is explained; or where the reader chooses estimators."""
    lesson = lessons()[name]
    for k, step in enumerate(lesson.steps if "estimators" not in lesson.controls else ()):
        end = next((j for j, other in enumerate(lesson.steps[k:], k + 1) if other.kind == EXPLAIN), len(lesson.steps))
        said = " ".join(f"{other.title} {other.text}" for other in lesson.steps[k:end])
        for numbers in lesson.variants if step.stage else ():
            asked = state.read(filled(step.stage, numbers)).scene.estimators
            assert not asked or any(name in said for name in (*ESTIMATORS, "estimat")), (step.key, asked)
