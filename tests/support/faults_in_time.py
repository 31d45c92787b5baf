"""Runs of ours whose files go wrong on the way: frames, times, names of particles, and values that do not go on."""

from collections.abc import Callable

import numpy as np

from solvers.judging import problem_handout
from tests.support.faults import ALL, Alteration, Files, RecordedRun, change_arrays, files, moving_particle

FIELDS = ("x", "v", "F", "sigma")


def take_frames(order: Callable[[int], np.ndarray]) -> Alteration:
    """The frames in another ``order``, which is made from their number, at the times as they were."""
    def altered(run: RecordedRun) -> Files:
        arrays = files(run)
        chosen = order(len(arrays["t"]))
        return arrays | {key: arrays[key][chosen] for key in FIELDS if key in arrays} | {"t": arrays["t"][:len(chosen)]}
    return altered


def exchanged(count: int) -> np.ndarray:
    order = np.arange(count)
    order[[count // 2, count // 2 + 1]] = count // 2 + 1, count // 2
    return order


def written_twice(count: int) -> np.ndarray:
    return np.where(np.arange(count) == count // 2 + 1, count // 2, np.arange(count))


def scale_later_times(factor: float) -> Alteration:
    """Intervals that are longer by a factor from half on."""
    def make(run: RecordedRun, arrays: Files) -> np.ndarray:
        t = arrays["t"]
        middle = t[len(t) // 2]
        return np.where(t > middle, middle + factor * (t - middle), t)
    return change_arrays(t=make)


def freeze_ten(key: str) -> Alteration:
    """A quantity of ten neighbours that stays from a third of the run on."""
    def altered(run: RecordedRun) -> Files:
        arrays = files(run, stress=key == "sigma")
        near = np.linalg.norm(arrays["X"] - arrays["X"][moving_particle(run)], axis=1)
        values, begin = arrays[key].copy(), len(arrays["t"]) // 3
        who = np.argsort(near)[:10]
        values[begin:, who] = values[begin, who]
        return arrays | {key: values}
    return altered


def damp_positions(run: RecordedRun, arrays: Files) -> np.ndarray:
    return arrays["X"] + (1 - 0.05 * arrays["t"] / arrays["t"][-1])[:, None, None] * (arrays["x"] - arrays["X"])


def permute_later_rows(run: RecordedRun) -> Files:
    arrays = files(run)
    order, half = np.random.default_rng(4).permutation(len(arrays["X"])), len(arrays["t"]) // 2
    return arrays | {key: np.concatenate([arrays[key][:half], arrays[key][half:, order]])
                     for key in FIELDS if key in arrays}


def stress_in_other_unit(run: RecordedRun) -> Files:
    arrays = files(run, stress=True)
    later = np.arange(len(arrays["t"]))[:, None, None, None] >= len(arrays["t"]) // 2
    return {key: values for key, values in arrays.items() if key != "F"} | {
        "sigma": np.where(later, 1e-3, 1.0) * arrays["sigma"]}


def double_one_volume(run: RecordedRun) -> Files:
    arrays, volume = files(run), problem_handout.start(run.scene).volume.copy()
    volume[moving_particle(run)] *= 2
    return arrays | {"volume": np.tile(volume, (len(arrays["t"]), 1))}


#: What is done to the files, of which problems, and what makes them.
IN_TIME: dict[str, tuple[tuple[str, ...], Alteration]] = {
    "two frames exchanged": (ALL, take_frames(exchanged)),
    "a frame written twice": (ALL, take_frames(written_twice)),
    "a frame missing, times renumbered": (ALL, take_frames(lambda count: np.delete(np.arange(count), count // 2))),
    "times doubled from half on": (ALL, scale_later_times(2)),
    "times in ms from half on": (ALL, scale_later_times(1000)),
    "v with the other sign": (ALL, change_arrays(v=lambda run, a: -a["v"])),
    "F of ten neighbours frozen": (ALL, freeze_ten("F")),
    "stress of ten neighbours frozen": (ALL, freeze_ten("sigma")),
    "x damped to 95 %": (ALL, change_arrays(x=damp_positions)),
    "rows permuted from half on": (ALL, permute_later_rows),
    "stress in kPa from half on, without F": (ALL, stress_in_other_unit),
    "one volume doubled, volumes in the file": (ALL, double_one_volume)}
