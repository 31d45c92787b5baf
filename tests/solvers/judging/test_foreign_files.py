"""Files as other codes, tools and people write them: read as what they are, or refused in one sentence of their own."""

import numpy as np
import pytest

from solvers.judging.check import CONSISTENT, check
from solvers.judging.moment_joining import join_moments
from solvers.judging.particle_readers import read_all
from solvers.judging.particle_scene_matching import match_files
from solvers.problems import PROBLEMS
from tests.support.foreign_files import CELLS, TIMES, frames
from tests.support.foreign_forms import FORMS, OTHERS

SCENE = PROBLEMS["ring"].scene(cells=CELLS)
WRITERS = {**{name: form.write for name, form in FORMS.items()}, **OTHERS}


@pytest.mark.parametrize("name", WRITERS)
def test_particles_of_others_are_those_that_we_wrote(name, tmp_path):
    files = list(map(str, WRITERS[name](tmp_path)))
    times = TIMES if name in FORMS and not FORMS[name].times else ()
    tables, cells, times_left = join_moments(read_all(files), [CELLS], times)
    _, [grid] = match_files(tables, SCENE, cells, times_left)
    assert grid.times == pytest.approx(TIMES, rel=1e-9)
    for frame, own in zip(grid.frames, frames(), strict=True):
        shift = frame.number.min() - own.number.min() if len(frame.number) else 0
        order = np.argsort(frame.number - shift)
        for key in ("material_position", "position", "velocity", "stress", "deformation_gradient"):
            mine = getattr(own, key)
            if (theirs := getattr(frame, key)) is not None:
                assert theirs[order] == pytest.approx(mine, rel=3e-8, abs=3e-8 * np.abs(mine).max()), key
    first = grid.frames[0]
    assert any(values is not None for values in (first.velocity, first.stress, first.deformation_gradient))
    assert check(files, times=times).verdict == CONSISTENT
