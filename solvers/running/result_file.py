"""File of a result: a .npz with its scene as a line of text, all samples, particles and estimates, without pickle.

Its particles are stored as ``mpm-lab judge`` reads them, so that a saved result is also a file of particles, and
``mpm-lab run --particles FILE.npz`` writes a saved result with more of them. A file is untrusted: every array must have
the name, type and shape that its scene requires, or the file is rejected."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from solvers.running.cures import Cure
from solvers.running.scene_json_line import parse_scene_json_line, scene_from_inputs, scene_line
from solvers.scene.scene import Scene
from solvers.solver import samples
from solvers.solver.particle_snapshot import Snapshot, WallTimes
from solvers.solver.soundness import BROKEN, OK
from solvers.untrusted.npz_reader import read_arrays as read_arrays
from solvers.untrusted.quoting import FileError, quote
from solvers.untrusted.size_limits import LIMITS

SCHEMA = "mpm-lab/result/1"
HINT = "write it with Result.save"
MOMENTS = ("final", "mid_run")
#: Arrays of a snapshot that always exist, and optional ones.
PLACES, ERRORS = ("material_position", "position", "velocity"), ("estimate", "difference")
MAX_TEXT = 2000  # letters
MAX_COUNT = 2**62  # bytes, steps


def particle_arrays(scene: Scene, times: Sequence[float], number: np.ndarray, X: np.ndarray, x: np.ndarray,
                    v: np.ndarray, F: np.ndarray) -> dict[str, Any]:
    """Returns the arrays, by name, that ``mpm-lab judge`` reads: ``number`` (P,) and rest positions X (P, D) in m of
    particles with x in m, v in m/s (T, P, D) and F (T, P, D, D) at T times in s, and their scene."""
    return {"t": np.array(times), "cells": np.array(scene.cells), "scene": np.array(scene_line(scene)), "id": number,
            "X": X, "x": x, "v": v, "F": F}


def result_arrays(values: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Returns arrays by name for ``values``, a Result's fields by name, without the particles that the judge reads."""
    moments = {name: values[name] for name in MOMENTS if values[name] is not None}
    said = {name: values[name] for name in values.keys() - {"scene", "series", "explanation", *MOMENTS}}
    said |= {"schema": SCHEMA, "seconds": asdict(values["seconds"]), "reason": values["explanation"],
             "advice": [*map(asdict, values["advice"])], "moments": {
        name: {"step": shot.step, "time": shot.time} for name, shot in moments.items()}}
    found = {"result": np.array(json.dumps(said, sort_keys=True)), "scene": np.array(scene_line(values["scene"]))}
    found |= {f"series/{name}": series for name, series in values["series"].items()}
    for name, shot in moments.items():
        for key, array in vars(shot).items():
            if isinstance(array, np.ndarray):
                found[f"{name}/{key}"] = array
            elif isinstance(array, dict):
                found |= {f"{name}/{key}/{estimator}": one for estimator, one in array.items()}
    return found


def write(path: str, values: Mapping[str, Any]) -> None:
    """Writes a Result's fields, by name, to a .npz, with particles as the judge reads them; raises FileError."""
    if not path.lower().endswith(".npz"):
        raise FileError(path, "is no name for a saved result; give one that ends in .npz")
    scene, shots = values["scene"], [values[name] for name in reversed(MOMENTS) if values[name] is not None]
    D, P = scene.DIMENSIONS, len(shots[0].position)
    x, v = (np.stack([getattr(shot, key).reshape(P, D) for shot in shots]) for key in ("position", "velocity"))
    F = np.stack([shot.deformation_gradient.reshape(P, D, D) for shot in shots])
    found = particle_arrays(scene, [shot.time for shot in shots], np.arange(P),
                            shots[0].material_position.reshape(P, D), x, v, F) | result_arrays(values)
    LIMITS.check_unpacked(path, sum(array.nbytes for array in found.values()))
    np.savez_compressed(path, **found)


def read(path: str) -> dict[str, Any]:
    """Returns a Result's fields, by name, from a .npz; raises :class:`FileError`, with the reason, if it has none."""
    try:
        found = read_arrays(path, lambda name: name in ("scene", "result") or "/" in name, LIMITS)
    except OSError as error:
        raise FileError.from_os_error(path, error) from None
    if "result" not in found or "scene" not in found:
        raise FileError(path, f"holds no result of a run; {HINT}")
    return _ResultReader(path, found).fields()


class _ResultReader:
    """Reader of a result's fields from a file's arrays by name, of which it checks type and shape."""

    def __init__(self, path: str, found: Mapping[str, np.ndarray]):
        self._path, self._found = path, found
        self._scene = scene_from_inputs(path, *parse_scene_json_line(path, str(found["scene"].item())))

    def fields(self) -> dict[str, Any]:
        try:
            said = json.loads(str(self._found["result"].item()))
            schema = said["schema"]
        except (ValueError, TypeError, KeyError, RecursionError):
            raise self._refusal("its text called result is none") from None
        if schema != SCHEMA:
            raise FileError(self._path, f"is of another version ({quote(schema)}), and {SCHEMA} can be read; {HINT}")
        try:
            return self._fields(said)
        except (ValueError, TypeError, KeyError, AttributeError, OverflowError) as error:
            if isinstance(error, FileError):
                raise
            raise self._refusal("its text called result does not say what one says") from None

    def _fields(self, said: dict[str, Any]) -> dict[str, Any]:
        status, not_valid, seconds = said["status"], said["not_valid"], said["seconds"]
        if status not in (OK, *BROKEN):
            raise ValueError(status)
        estimators = {_validated_text(name): _validated_number(part) for name, part in seconds["estimators"].items()}
        moments = {name: self._snapshot(name, said["moments"][name]) if name in said["moments"] else None
                   for name in MOMENTS}
        if moments["final"] is None:
            raise KeyError("final")
        return {"scene": self._scene, "status": status, "explanation": _maybe(_validated_text, said["reason"]),
                "broken_at": _maybe(_validated_number, said["broken_at"]), "time": _validated_number(said["time"]),
                "steps": _validated_count(said["steps"]), "series": self._series(), **moments,
                "bytes": _validated_count(said["bytes"]), "threads": _validated_count(said["threads"]),
                "arch": _validated_text(said["arch"]), "plan": _validated_text(said["plan"]),
                "not_valid": {_validated_text(name): _validated_text(why) for name, why in not_valid.items()},
                "seconds": WallTimes(_validated_number(seconds["setup"]), _validated_number(seconds["compile"]),
                                     _validated_number(seconds["run"]), estimators),
                "advice": tuple(self._cure(**cure) for cure in said.get("advice", [])),
                "goals": {_validated_text(name): _validated_goal(goal) for name, goal in said.get("goals", {}).items()}}

    def _cure(self, change: dict[str, Any], text: str, tried: bool, held: bool) -> Cure:
        replace(self._scene, **change)  # raises an error for what no scene has
        return Cure(change, _validated_text(text), tried is True, held is True)

    def _series(self) -> dict[str, np.ndarray]:
        """Returns all T sampled norms by name, each (T,) in SI."""
        columns = samples.column_names(self._scene.active_estimators, self._scene.active_effects)
        names = [*(name for name in columns if name != "step"), "time"]
        if f"series/{samples.BUDGET[0]}" in self._found:
            names += samples.BUDGET
        T = self._found.get("series/time", np.empty(0)).size
        if T == 0:
            raise self._refusal("it has no samples")
        ordered = [name.removeprefix("series/") for name in self._found if name.startswith("series/")]
        if set(ordered) != set(names):
            raise self._refusal("its samples are not those of its scene")
        return {name: self._array(f"series/{name}", (T,)) for name in ordered}

    def _snapshot(self, moment: str, said: dict[str, Any]) -> Snapshot:
        D = self._scene.DIMENSIONS
        places = {} if D == 1 else {"position": (D,), "material_position": (D,), "velocity": (D,),
                                    "deformation_gradient": (D, D)}
        P = len(np.atleast_1d(self._found.get(f"{moment}/position", np.empty(0))))
        if P == 0:
            raise self._refusal(f"it has no particles ({moment})")
        whole: dict[str, Any] = {key: self._array(f"{moment}/{key}", (P, *places.get(key, ())))
                                 for key in (*PLACES, "deformation_gradient")}
        each: dict[str, Any] = {key: {
            name: self._array(f"{moment}/{key}/{name}", (P, len(samples.QUANTITIES)))
            for name in self._scene.active_estimators if f"{moment}/{key}/{name}" in self._found} for key in ERRORS}
        return Snapshot(step=_validated_count(said["step"]), time=_validated_number(said["time"]), **whole, **each,
                        error=self._optional_array(f"{moment}/error", (P, len(samples.QUANTITIES))),
                        last_crossing=self._optional_array(f"{moment}/last_crossing", (P,), "i"),
                        plotted=self._optional_array(f"{moment}/plotted", (P, 2)))

    def _optional_array(self, name: str, shape: tuple[int, ...], kind: str = "f") -> np.ndarray | None:
        return self._array(name, shape, kind) if name in self._found else None

    def _array(self, name: str, shape: tuple[int, ...], kind: str = "f") -> np.ndarray:
        array = self._found.get(name)
        if array is None:
            raise self._refusal(f"it has no {name}")
        if array.shape != shape or array.dtype.kind != kind or (kind == "f" and array.dtype != np.float64):
            raise self._refusal(f"{quote(name)} is {array.dtype} of the shape {array.shape}, not {shape}")
        return array

    def _refusal(self, why: str) -> FileError:
        return FileError(self._path, f"holds no result of a run ({why}); {HINT}")


def _maybe(validate: Any, value: Any) -> Any:
    return None if value is None else validate(value)


def _validated_goal(said: dict[str, Any]) -> dict[str, Any]:
    numbers = {key: _maybe(_validated_number, said[key]) for key in ("true_error", "rounding")}
    each = {key: {_validated_text(name): _maybe(_validated_number, value) for name, value in said[key].items()}
            for key in ("estimated_error", "bar")}
    return {"value": _maybe(_validated_number, said["value"]), "unit": _validated_text(said["unit"]), **numbers, **each}


def _validated_text(value: Any) -> str:
    if not isinstance(value, str) or len(value) > MAX_TEXT or not value.isprintable():
        raise TypeError
    return value


def _validated_number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise TypeError
    return float(value)


def _validated_count(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= MAX_COUNT:
        raise TypeError
    return value
