"""Files of bodies: those that come with the package, and what is refused, each with a sentence that names it."""

import math
import random

import pytest

from solvers.bodies import body_file
from solvers.bodies.body import Body
from solvers.bodies.body_file import library_names, library_text, parse_body, read_body
from solvers.bodies.goal import Goal
from solvers.bodies.patch import Patch
from solvers.scene.validation import SceneError
from solvers.untrusted.quoting import FileError

CANTILEVER = library_text("cantilever")
PLATE = library_text("plate_with_hole")
BLOCK = Body(patches=(Patch(((0, 0), (4, 0), (4, 1), (0, 1)), ("free", "free", "free", "clamped")),),
             youngs_modulus=4e6, poissons_ratio=0.3, density=1050, gravity=(0, -10), cells_per_metre=8, ppc=2,
             elements_across=2, t_end=1.8, domain=((-1, -4), (5, 2)), goals={
                 "lowest": Goal("min y", (4, 0.5)), "period": Goal("time of return y", (4, 0.5)),
                 "stress": Goal("max |sigma_xx|", (1, 1))})


def test_a_file_is_an_object():
    assert parse_body(CANTILEVER) == BLOCK


@pytest.mark.parametrize("name", library_names())
def test_bodies_that_come_along_are_short_and_valid(name):
    assert len(library_text(name).splitlines()) <= 25
    body = parse_body(library_text(name))
    assert body.goals and body.has_known_corners == (name in ("cantilever", "swinging_sector"))


#: What is changed in the cantilever's file, and what the sentence must say of it.
REFUSED = [
    ("poissons_ratio = 0.3", "poissons_ratio = 0.495", "poissons ratio 0.495: give a number from 0 to 0.49"),
    ("youngs_modulus = 4e6", "youngs_modulus = 1e-300", "give a number above 1e-15"),
    ("density = 1050", "density = -1", "density -1: give a number above 1e-15"),
    ("density = 1050", "density = nan", "density nan: give a number above 1e-15"),
    ("density = 1050", "density = '1050'", "density '1050': give a number above 1e-15"),
    ("density = 1050", "", r"^file \[material\]: lacks density"),
    ("density = 1050", "density = 1050\nyield_stress = 1e5", "yield_stress.*plastic, viscous or damaging"),
    ("density = 1050", "density = 1050\nviscosity = 1", "viscosity.*plastic, viscous or damaging"),
    ("[0, -10]", "[0, nan]", r"gravity \(0, nan\): give \[x, y\], two numbers in m/s\^2 of size up to 1e\+06"),
    ("corners = [[0, 0]", "corners = [[0, 0, 0]", "two numbers in m of size up to"),
    ("corners = [[0, 0], [4, 0], [4, 1], [0, 1]]", "corners = []", "give four points"),
    ("[[-1, -4], [5, 2]]", "[[5, 2], [-1, -4]]", "does not contain the body"),
    ("youngs_modulus = 4e6", "youngs_modulus = 1e14", "takes .* steps; at most"),
    ("elements_across = 2", "elements_across = 0", "elements across 0: give a whole number from 1 to 20"),
    ("lowest =", '"<b>x</b>" =', "is no name of a goal"),
    ("[goals]", "[goals]\n" + "\n".join(f"g{k} = {{ value = 'min y', at = [1, 1] }}" for k in range(30)), "at most 20"),
    ("gravity = [0, -10]", f'force = ["{"(" * 500}", "0"]', "has 500 characters; at most 400"),
    ("gravity = [0, -10]", 'velocity = ["exp(1000*X)*X", "0"]', "is not finite everywhere"),
    ("[load]", "[[load]]", "is no table"),
    ("gravity = ", "traction = ", "traction.*loads on sides"),
    ("[load]", "[contact]\nwall = 1\n[load]", "contact: is not known; give patch, material"),
    ('"clamped"]', '"glued"]', "patch 1 sides glued: is not known.*free, clamped, roller"),
    ("[0, 1]]", "[0, 1], [0, 2]]", "give four points"),
    ("[[0, 0], [4, 0], [4, 1], [0, 1]]", "[[0, 1], [4, 1], [4, 0], [0, 0]]", "fold the patch over or go clockwise"),
    ("[[0, 0], [4, 0], [4, 1], [0, 1]]", "[[900, 0], [900.0004, 0], [900.0004, 1e-4], [900, 1e-4]]",
     "farther from the origin than 1,000,000 times"),
    ("[4, 1], [0, 1]]", "[2.2, 0.6], [0, 1]]", "have an angle of .* degrees"),
    ("[[0, 0], [4, 0]", "[[0.5, 0], [4, 0]", "no straight line along x or y"),
    ("cells_per_metre = 8", "cells_per_metre = 7.3", "7.3 m|puts|patch 1 29.2|particles wide"),
    ("t_end = 1.8", "t_end = 0", "t end 0: give a number above 1e-15"),
    ("t_end = 1.8", "t_end = inf", "t end inf: give a number above 1e-15"),
    ("[[-1, -4], [5, 2]]", "[[1, -4], [5, 2]]", "does not contain the body"),
    ("[[-1, -4], [5, 2]]", "[[-1e6, -4], [5, 2]]", "cells long; at most 2,000"),
    ("cells_per_metre = 8", "cells_per_metre = 100_000", "cells long; at most 2,000"),
    ("t_end = 1.8", "t_end = 1e9", "steps; at most 10,000,000"),
    ("gravity = [0, -10]", 'velocity = ["0", "__import__(1)"]', "calls __import__, which is no function here"),
    ("gravity = [0, -10]", 'velocity = ["0", "1"]', "moves the clamped side west of patch 1"),
    ("gravity = [0, -10]", 'force = ["0", "1/X"]', "is not finite everywhere"),
    ("gravity = [0, -10]", 'velocity = ["0", "t"]', "has the name t, which is not known"),
    ('method = "cpdi"', 'method = "fem"', "method fem: is not known"),
    ("ppc = 2", "ppc = 2.5", "ppc 2.5: give a whole number"),
    ('"min y"', '"peak stress"', "at a clamped corner the stress is infinite"),
    ('"min y"', '"min z"', "is no number that is computed"),
    ("at = [4, 0.5]", "at = [4.1, 0.5]", "is at no material point"),
    ("[[patch]]", "[patch]", r"give patches in tables with two brackets"),
]


@pytest.mark.parametrize(("old", "new", "sentence"), REFUSED, ids=[f"{new}"[:40] for _, new, _ in REFUSED])
def test_refusals_name_what_is_wrong(old, new, sentence):
    assert old in CANTILEVER
    with pytest.raises(SceneError, match=sentence) as caught:
        parse_body(CANTILEVER.replace(old, new))
    assert str(caught.value).isprintable()


@pytest.mark.parametrize(("old", "new", "sentence"), [
    ("arc = { west = [0, 0] }     #", "arc = { west = [0.1, 0] } #", "from one end of the side west"),
    ("[1, 1], [0, 1], [0, 0.25]]", "[1, 1], [0, 1], [0, 0.3]]", "from one end of the side west"),
    ("corners = [[0.17677669529663687, 0.17677669529663687], [1, 1]",
     "corners = [[0.17, 0.18330302779823363], [1, 1]",
     "not joined|elsewhere than along whole sides"),
    ('"free", "roller", "free"]', '"free", "free", "roller"]', "no straight line along x or y"),
    ('["free", "free", "roller", "free"]', '["clamped", "free", "roller", "free"]', "is a side within the body"),
    ('["free", "free", "roller", "free"]', '["free", "free", "clamped", "free"]', "moves the clamped side north"),
])
def test_patches_that_do_not_fit(old, new, sentence):
    assert old in PLATE
    with pytest.raises(SceneError, match=sentence):
        parse_body(PLATE.replace(old, new))


def test_a_byte_order_mark_and_other_line_ends_change_nothing(tmp_path):
    path = tmp_path / "body.toml"
    path.write_bytes(CANTILEVER.replace("\n", "\r\n").encode("utf-8-sig"))
    assert read_body(str(path)) == BLOCK


SQUARE = "[[patch]]\ncorners = [[0, 0], [1, 0], [1, 1], [0, 1]]\n"
REST = (library_text("thrown_block").partition("[[patch]]")[0]
        + "[run]\ncells_per_metre = 8\nt_end = 1\ndomain = [[-9, -9], [9, 9]]\n")


@pytest.mark.parametrize(("corners", "sentence"), [
    ("[[1, 0], [2, 0], [2, 0.5], [1, 0.5]]", "elsewhere than along whole sides"),
    ("[[0.5, 0.5], [1.5, 0.5], [1.5, 1.5], [0.5, 1.5]]", "elsewhere than along whole sides"),
    ("[[0, 0], [1, 0], [1, 1], [0, 1]]", "overlap|shares"),
    ("[[2, 0], [3, 0], [3, 1], [2, 1]]", "not joined to the others"),
    ("[[1, 1], [2, 1], [2, 2], [1, 2]]", "not joined to the others")])
def test_two_patches_that_do_not_fit(corners, sentence):
    with pytest.raises(SceneError, match=sentence):
        parse_body(f"{REST}{SQUARE}[[patch]]\ncorners = {corners}\n")


def test_a_held_side_has_the_body_on_one_side_and_its_line_to_itself():
    left = "[[patch]]\ncorners = [[-1, 0], [0, 0], [0, 1], [-1, 1]]\n"
    above = "[[patch]]\ncorners = [[0, 1], [1, 1], [1, 2], [0, 2]]\n"
    with pytest.raises(SceneError, match="a held side must be the body's outermost"):
        parse_body(f"{REST}{SQUARE}{left}{above}sides = ['free', 'free', 'free', 'clamped']\n")
    with pytest.raises(SceneError, match="is a free side on the line of one that is held"):
        parse_body(f"{REST}{SQUARE}{above}sides = ['free', 'free', 'free', 'clamped']\n")


@pytest.mark.parametrize("content", [b"\xff\xfe", b"[material", b"[" * 50_000, b"#" * 200_000,
                                     b"a = 1\na = 2", b"\x00", b"a = " + b"1" * 5000])
def test_files_that_are_no_toml(tmp_path, content):
    path = tmp_path / "body.toml"
    path.write_bytes(content)
    with pytest.raises(FileError, match=r"body\.toml"):
        read_body(str(path))
    with pytest.raises(FileError, match="cannot be read"):
        read_body(str(tmp_path / "none.toml"))


@pytest.mark.parametrize("seed", range(8))
def test_hostile_values_never_raise_anything_else(seed):
    """Every value of a file in turn is replaced by something of another kind."""
    rng = random.Random(seed)
    values = ["[]", "{}", "true", "1979-05-27", "'x'", "[[[1]]]", "-1e308", "inf", "9" * 400, '"\\u202e\\u0007"', "[1]",
              "[true, false]", "[1e300, 1]", "{ a = [0] }", '["1/0", "1/0"]', '["X**9999", "0"]']
    lines = library_text(rng.choice(library_names())).splitlines()
    for number, line in enumerate(lines):
        if " = " in line:
            changed = [*lines[:number], f"{line.partition(' = ')[0]} = {rng.choice(values)}", *lines[number + 1:]]
            try:
                body_file.parse_body("\n".join(changed))
            except (SceneError, body_file.tomllib.TOMLDecodeError) as error:
                assert len(str(error)) <= 500


def test_warnings():
    """Of hat functions, of a clamped corner whose singularity is not known, of fronts from free edges."""
    assert parse_body(CANTILEVER).warnings() == []
    assert "hat functions" in parse_body(CANTILEVER.replace("cpdi", "mpm")).warnings()[0]
    slanted = CANTILEVER.replace("[4, 1], [0, 1]]", "[4, 1], [0, 2]]")
    assert "at a corner of 76 degrees" in parse_body(slanted.replace("at = [1, 1]", "at = [1, 0]")).warnings()[0]
    above = "[[patch]]\ncorners = [[0, 1], [1, 1], [1, 2], [0, 2]]\n"
    angle = f"{REST}{SQUARE}{above}[[patch]]\ncorners = [[1, 1], [2, 1], [2, 2], [1, 2]]\n"
    assert "at a corner of 270 degrees" in parse_body(angle).warnings()[0]
    turning = library_text("thrown_block").replace(" + 2*(X - 0.5)", "").replace(" - 2*(Y - 0.5)", "")
    assert "steep fronts" in parse_body(library_text("thrown_block")).warnings()[0]
    assert parse_body(turning).warnings() == []


def test_strips_of_patches_have_equal_counts():
    """Through the plate's seam: along the strip from one roller to the other only the radial counts are shared."""
    counts = parse_body(PLATE).lattice_counts
    assert counts[0, 0] == counts[1, 0] == round(64 * (0.75 + math.sqrt(2) - 0.25) / 2)
