"""Words about a scene come from the scene: what does not swing is not the patch test of the bar; sizes with units; and
sentences as the page has them."""

from dataclasses import dataclass, replace

import pytest

from app import names_and_units
from app.language.translation import use_language
from solvers.problems import PROBLEMS
from solvers.problems.bar.patch_test_inputs import PATCH
from solvers.problems.bar.scene import BarScene
from solvers.scene.validation import SceneError


@dataclass(frozen=True)
class SlidingScene(BarScene):
    """A bar that slides through the grid."""

    TITLE = "sliding bar"
    swings = False
    motion_fields = ("initial_velocity",)


def test_what_does_not_swing_has_its_own_title_and_motion():
    scene = SlidingScene()
    assert scene.title == "sliding bar" and names_and_units.motion_text(scene) == "v = 1 m/s"
    assert names_and_units.in_a_line(scene).startswith("Sliding bar: ") and "patch" not in names_and_units.in_a_line(
        scene
    )


def test_a_patch_test_says_so():
    scene = BarScene(motion=PATCH, cells=8, ppc=2.5)
    assert (
        scene.title == "patch test of the bar"
        and names_and_units.motion_text(scene) == "patch test, F = 1.02, v = 1 m/s"
    )
    assert names_and_units.in_a_line(scene).lower().count("patch test") == 1
    assert "--motion patch" in names_and_units.command_line(
        scene
    ) and "--body-force" not in names_and_units.command_line(scene)
    assert names_and_units.motion_text(replace(BarScene(), amplitude=0.025)) == "A = 25 mm"


@pytest.mark.parametrize(("value", "text"), [
    (0.00212, "2.12 mm"), (999.9e-6, "1 mm"), (1.0, "1 m"), (3.4e5, "340 km"), (0.0, "0 m"), (2e-20, "2.00e-20 m")])
def test_units_have_prefixes(value, text):
    assert names_and_units.with_unit(value, "m") == text


@pytest.mark.parametrize(("count", "text"), [(1.0004, "1 period"), (0.9996, "1 period"), (1.01, "1.01 periods"),
                                             (2.5, "2.5 periods")])
def test_what_reads_as_one_is_one(count, text):
    assert names_and_units.in_periods(count) == text


def test_an_amplitude_is_a_length_or_an_angle():
    assert [names_and_units.unit_of(problem.scene,
                                    "amplitude") for problem in PROBLEMS.values()] == ["m", "m", "m", "rad"]


@pytest.mark.parametrize("text, unit, value", [
    ("25 mm", "m", 0.025), ("0.025", "m", 0.025), ("0,025 m", "m", 0.025), (" 2.5e-2m ", "m", 0.025),
    ("1e3", "Pa", 1e3), ("16 kPa", "Pa", 16e3), ("3 µm", "m", 3e-6), ("0.5 periods/s", "periods/s", 0.5)])
def test_a_size_is_read_as_it_is_written(text, unit, value):
    assert names_and_units.parse_size(text, unit) == pytest.approx(value, rel=1e-11)
    assert names_and_units.parse_size(names_and_units.with_unit(value, unit, 6), unit) == pytest.approx(value, rel=1e-5)


@pytest.mark.parametrize("text, unit", [("", "m"), ("a lot", "m"), ("0", "m"), ("-1", "m"), ("25 kg", "m"), ("e", "Pa"),
                                        ("1e999", "m"), ("1e-999", "m"), ("5 k", ""), ("1.2.3", "m"), ("nan", "m")])
def test_what_is_no_size_is_refused(text, unit):
    with pytest.raises(ValueError):
        names_and_units.parse_size(text, unit)


def test_sentences_name_what_stands_beside_the_widgets():
    """A visitor has no flags: the box, the choice and the remedies are called as the page calls them."""
    assert names_and_units.reword_for_page("steps (--dt auto takes 0.1 s)") == 'steps (the box "Auto step" takes 0.1 s)'
    assert (
        names_and_units.reword_for_page(
            "ugimp needs 98 cells, cfl 0.5; mpm-lab run bar --method mpm; cpgimp-v, or bspline"
        )
        == "uGIMP needs 98 cells, CFL 0.5; mpm-lab run bar --method mpm; cpGIMP (V), or B-spline"
    )
    assert (
        names_and_units.reword_for_page("use the remedies null-space-filter,coupled-deformation, or choose CPDI")
        == 'use the remedies "null-space filter" and "displacement-coupled F", or choose CPDI'
    )
    with pytest.raises(SceneError) as refusal:
        BarScene(remedies=("frozen-weights", "zero-drift"))
    assert names_and_units.reword_for_page(str(refusal.value)).startswith('remedies "frozen weights", "zero drift": ')


def test_coordinates_can_be_told_apart_where_numbers_have_commas():
    assert names_and_units.format_coordinates((0.4125, 4.0)) == "0.412, 4"
    with use_language("de"):
        assert names_and_units.format_coordinates((0.4125, 4.0)) == "0,412; 4"
