"""Arrays lie where whole vectors may be read: an array that does not would crash the process, not fail a test."""

import numpy as np
import pytest

from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.running.run import build
from solvers.solver.state_arrays import ALIGNMENT, aligned_copy


@pytest.mark.parametrize("kind", [np.int32, np.float64])
@pytest.mark.parametrize("shape", [(1,), (7,), (1001, 4), (50_000, 8)])
def test_aligned_copy_are_equal_and_in_place(shape, kind):
    array = np.arange(np.prod(shape)).reshape(shape).astype(kind)
    copy = aligned_copy(array)
    assert copy.ctypes.data % ALIGNMENT == 0 and copy.flags.c_contiguous and copy.dtype == kind
    np.testing.assert_array_equal(copy, array)
    copy[0] += 1
    assert (copy[0] != array[0]).all()


@pytest.mark.parametrize("scene", [BarScene(), RingScene(), RingScene(method="ugimp", plan="parallel", threads=2)])
def test_every_array_of_a_solver_is_aligned(scene):
    arrays = {name: a for name, a in build(scene)._arrays.members().items() if isinstance(a, np.ndarray)}
    assert [name for name, array in arrays.items() if array.ctypes.data % ALIGNMENT] == []
