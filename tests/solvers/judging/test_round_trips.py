"""Files of particles: what is written is read again to the bit, in each form, whatever the numbers are."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from solvers.judging import particle_writers
from solvers.judging.particle_data_types import Frame, RawTable
from solvers.judging.particle_readers import read_file
from solvers.judging.particle_writers import vtu_bytes
from solvers.problems.bar.scene import BarScene

# None so small that they are not normal: where Taichi has started, the processor takes those for zero.
NUMBERS = st.floats(-1e300, 1e300, allow_subnormal=False)
TIMES = st.floats(0.0, 1e6, allow_subnormal=False)


@st.composite
def frames(draw: st.DrawFn) -> list[Frame]:
    """Frames of the same particles, 1 to 3 of them, on a line or in the plane, at different times in order. Not as many
    particles as dimensions: two points X in the plane could be two times of two points on a line."""
    D, P = draw(st.sampled_from([(1, 2), (1, 5), (2, 1), (2, 3), (2, 5)]))
    number = draw(arrays(np.int64, P, elements=st.integers(0, 2**31), unique=True))
    X = draw(arrays(float, (P, D), elements=NUMBERS))
    times = sorted(draw(st.lists(TIMES, min_size=1, max_size=3, unique=True)))

    def values(*shape: int) -> np.ndarray:
        return draw(arrays(float, (P, *shape), elements=NUMBERS))

    return [Frame("", t, number, X, values(D), values(D), values(D, D), values(D, D)) for t in times]


def assert_same(raw: RawTable, made: list[Frame], keys: str) -> None:
    """The rows of a file are those of the frames, to the bit."""
    T, P = len(made), len(made[0].number)
    np.testing.assert_array_equal(raw.columns["t"] if "t" in raw.columns else raw.time,
                                  np.repeat([f.time for f in made], P) if "t" in raw.columns else made[0].time)
    np.testing.assert_array_equal(raw.columns["id"], np.tile(made[0].number, T))
    for key in keys.split():
        written = np.concatenate([getattr(f, particle_writers.FRAME_FIELDS[key]) for f in made])
        np.testing.assert_array_equal(raw.columns[key].reshape(written.shape), written, err_msg=key)


@pytest.mark.parametrize("kind", ["csv", "npz", "vtu"])
def test_what_is_written_is_read(kind, tmp_path):
    @settings(max_examples=40, suppress_health_check=list(HealthCheck))
    @given(frames())
    def same(made):
        file = tmp_path / f"particles.{kind}"
        if kind == "csv":
            file.write_bytes(particle_writers.csv_text(particle_writers.frame_columns(made), {"cells": 12}))
            assert_same(read_file(str(file)), made, "X x v F sigma")
        elif kind == "npz":
            file.write_bytes(particle_writers.npz_bytes(made, BarScene(cells=12)))
            assert_same(read_file(str(file)), made, "X x v F")
        else:  # one frame, in space; tensors as nine numbers
            one, D = made[0], made[0].position.shape[1]
            in_space = {"velocity": np.pad(one.velocity, [(0, 0), (0, 3 - D)]),
                        "stress": np.pad(one.stress, [(0, 0), (0, 3 - D), (0, 3 - D)]).reshape(-1, 9)}
            file.write_bytes(vtu_bytes(one.position, {"id": one.number, **in_space}, one.time))
            raw = read_file(str(file))
            assert raw.time == one.time and (raw.columns["id"] == one.number).all()
            for key, value in (("x", one.position), ("v", one.velocity), ("sigma", one.stress)):
                np.testing.assert_array_equal(raw.columns[key][(slice(None), *[slice(D)] * (value.ndim - 1))], value)
        if kind != "vtu":
            assert read_file(str(file)).cells == 12

    same()
