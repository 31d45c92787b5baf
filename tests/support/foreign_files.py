"""Writers of particles of a ring as other codes, tools and people write them: their names and forms, our numbers."""

from __future__ import annotations

import functools
import gzip
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from solvers.judging.particle_data_types import Frame
from solvers.judging.particle_writers import vtu_bytes
from solvers.judging.problem_handout import exact_frame
from solvers.problems import PROBLEMS

CELLS, TIMES = 12, (0.0, 0.0025, 0.005)
FIGURES = 9  # of text
Columns = dict[str, np.ndarray]


@functools.cache
def frames() -> tuple[Frame, ...]:
    """The exact particles, off by 1e-4 m and the like, so that there is an error to find."""
    scene, found = PROBLEMS["ring"].scene(cells=CELLS), []
    for t in TIMES:
        frame = exact_frame(scene, t)
        X = frame.material_position
        off = 1e-4 * np.sin(7 * X + 300 * t)
        found.append(replace(frame, position=frame.position + off, velocity=frame.velocity + 100 * off,
                             stress=frame.stress + 1e6 * (off[:, :, None] + off[:, None, :])))
    return tuple(found)


def components(frame: Frame, start: int = 0) -> Columns:
    """The particles as columns with plain names; ids from ``start``; the third direction where codes have it."""
    u, s, F = frame.position - frame.material_position, frame.stress, frame.deformation_gradient
    zero = np.zeros(len(u))
    return {"id": frame.number + start, "x": frame.position[:, 0], "y": frame.position[:, 1], "z": zero,
            "X": frame.material_position[:, 0], "Y": frame.material_position[:, 1], "Z": zero, "ux": u[:, 0],
            "uy": u[:, 1], "uz": zero, "vx": frame.velocity[:, 0], "vy": frame.velocity[:, 1], "vz": zero,
            "sxx": s[:, 0, 0], "sxy": s[:, 0, 1], "syx": s[:, 1, 0], "syy": s[:, 1, 1], "szz": 0.3 * s[:, 0, 0],
            "Fxx": F[:, 0, 0], "Fxy": F[:, 0, 1], "Fyx": F[:, 1, 0], "Fyy": F[:, 1, 1], "0": zero,
            "row": np.arange(len(u)),
            "steel": np.full(len(u), "steel"), "empty": np.full(len(u), "")}


@dataclass(frozen=True)
class Text:
    """Form of a text: its ``names`` are those in the heading, each with the column of :func:`components` below it."""

    names: dict[str, str]
    separator: str = ","
    above: str = "# t = {t}\n"  # the heading; {t} is the time
    heading: str = "{names}\n"
    row: Callable[[str], str] = str  # what becomes of a row
    number: Callable[[str], str] = str  # and of each number
    ending: str = ".csv"
    encoding: str = "utf-8"
    start: int = 0  # of ids
    permuted: bool = False
    one_file: bool = False

    def __call__(self, folder: Path) -> list[Path]:
        parts = []
        for k, frame in enumerate(frames()):
            columns = components(frame, self.start)
            order = np.random.default_rng(k).permutation(len(frame.number)) if self.permuted else slice(None)
            lines = [self.separator.join(map(self._cell, row)) for row in
                     zip(*(columns[column][order].tolist() for column in self.names.values()), strict=True)]
            head = self.above.format(t=self.number(f"{frame.time}")) + \
                self.heading.format(names=self.separator.join(self.names), n=len(lines))
            parts.append(head + "".join(f"{self.row(line)}\n" for line in lines))
        texts = ["".join(parts)] if self.one_file else parts
        files = [folder / f"theirs_{k}{self.ending}" for k in range(len(texts))]
        for file, text in zip(files, texts, strict=True):
            content = text.encode(self.encoding)
            file.write_bytes(gzip.compress(content) if self.ending.endswith(".gz") else content)
        return files

    def _cell(self, value: object) -> str:
        return value if isinstance(value, str) else str(value) if isinstance(value, int) else \
            self.number(f"{value:.{FIGURES}g}")


def same(*names: str) -> dict[str, str]:
    """Names that are those of the columns."""
    return {name: name for name in names}


PLAIN = same("id", "x", "y", "vx", "vy")
STRESS = same("sxx", "syy", "sxy")


def comma(number: str) -> str:
    return number.replace(".", ",")


def fortran(number: str) -> str:
    """As D24.16 writes it; nothing but rounding stands for zero, whose exponent leaves no place for a letter."""
    return "1.00000000-120" if number == "0" else f"{float(number):.8e}".replace("e", "D")


def quoted(line: str, separator: str = ",") -> str:
    return ",".join(f'"{cell}"' for cell in line.split(separator))


def vtk(folder: Path, ending: str, arrays: Callable[[Columns], dict[str, np.ndarray]], points: str = "xyz",
        time: bool = True) -> list[Path]:
    """Files .vtu, or .vtp by the same writer."""
    files = []
    for k, frame in enumerate(frames()):
        columns = components(frame)
        content = vtu_bytes(np.stack([columns[name] for name in points], axis=1), arrays(columns), frame.time)
        if not time:
            content = content.replace(b"TimeValue", b"CycleNo__")
        if ending == ".vtp":
            content = content.replace(b"UnstructuredGrid", b"PolyData").replace(b"Cells", b"Verts")
        files.append(folder / f"theirs_{k}{ending}")
        files[-1].write_bytes(content)
    return files


def stacked(columns: Columns, *names: str) -> np.ndarray:
    return np.stack([columns[name] for name in names], axis=1)


def cb_geo(folder: Path) -> list[Path]:
    return vtk(folder, ".vtp", lambda c: {
        "velocities": stacked(c, "vx", "vy", "vz"), "displacements": stacked(c, "ux", "uy", "uz"), "id": c["id"],
        "stresses": stacked(c, "sxx", "syy", "szz", "sxy", "0", "0"), "strains": stacked(c, "0", "0", "0")})


def kratos(folder: Path) -> list[Path]:
    return vtk(folder, ".vtu", lambda c: {
        "MP_DISPLACEMENT": stacked(c, "ux", "uy", "uz"), "MP_VELOCITY": stacked(c, "vx", "vy", "vz"),
        "MP_CAUCHY_STRESS_VECTOR": stacked(c, "sxx", "syy", "sxy"), "MP_DENSITY": c["0"]})


def anura3d(folder: Path) -> list[Path]:
    """Three files for each moment, of which one alone has the ids."""
    files = []
    for k, frame in enumerate(frames()):
        c = components(frame)
        tensor = stacked(c, "sxx", "sxy", "0", "syx", "syy", "0", "0", "0", "szz")
        for name, kind, values in (("material_point_id", "SCALARS {} double 1\nLOOKUP_TABLE default", c["id"] + 1),
                                   ("velocity_solid", "VECTORS {} double", stacked(c, "vx", "vy", "vz")),
                                   ("total_stress_solid", "TENSORS {} double", tensor)):
            lines = ["# vtk DataFile Version 3.0", "MP data", "ASCII", "DATASET UNSTRUCTURED_GRID",
                     "FIELD FieldData 1", "TIME 1 1 double", f"{frame.time}",
                     f"POINTS {len(c['x'])} double", *map(row_text, stacked(c, "x", "y", "z")),
                     f"POINT_DATA {len(c['x'])}", kind.format(name), *map(row_text, values.reshape(len(values), -1))]
            files.append(folder / f"{name}_{k}.vtk")
            files[-1].write_text("\n".join(lines) + "\n")
    return files


def row_text(row: np.ndarray) -> str:
    return " ".join(f"{value:.{FIGURES}g}" for value in row)


def ample(folder: Path) -> list[Path]:
    files = []
    for k, frame in enumerate(frames()):
        c = components(frame)
        lines = ["# vtk DataFile Version 2.0", "MATLAB generated vtk file, WMC", "ASCII", "DATASET UNSTRUCTURED_GRID",
                 f"POINTS {len(c['x'])} double", *map(row_text, stacked(c, "x", "y", "z")), "",
                 f"POINT_DATA {len(c['x'])}"]
        for name, column in (("sigma_xx", "sxx"), ("sigma_yy", "syy"), ("sigma_zz", "szz"), ("sigma_xy", "sxy"),
                             ("sigma_yz", "0"), ("sigma_zx", "0"), ("u_x", "ux"), ("u_y", "uy")):
            lines += [f"SCALARS {name} FLOAT 1", "LOOKUP_TABLE default", *map(row_text, c[column][:, None]), ""]
        files.append(folder / f"mpData_{k}.vtk")
        files[-1].write_text("\n".join(lines) + "\n")
    return files


def geotaichi(folder: Path) -> list[Path]:
    files = []
    for k, frame in enumerate(frames()):
        c = components(frame)
        order = np.random.default_rng(k).permutation(len(frame.number))
        files.append(folder / f"MPMParticle{k:06}.npz")
        np.savez(files[-1], t_current=frame.time, body_num=1, particle_num=len(order), particleID=c["id"][order],
                 position=stacked(c, "x", "y", "z")[order], velocity=stacked(c, "vx", "vy", "vz")[order],
                 stress=stacked(c, "sxx", "syy", "szz", "sxy", "0", "0")[order], state_vars=np.array({"a": 1}))
    return files


def collection(folder: Path) -> list[Path]:
    """Files without times, and one that has them."""
    files = vtk(folder, ".vtu", lambda c: {"id": c["id"], "velocity": stacked(c, "vx", "vy", "vz")}, time=False)
    sets = "".join(f'<DataSet timestep="{t}" group="" part="0" file="{file.name}"/>'
                   for t, file in zip(TIMES, files, strict=True))
    (folder / "theirs.pvd").write_text(f'<?xml version="1.0"?><VTKFile type="Collection" version="0.1"><Collection>'
                                       f'{sets}</Collection></VTKFile>')
    return [folder / "theirs.pvd"]


def halves(columns: Columns, part: int) -> Columns:
    return {name: values[part::2] for name, values in columns.items()}


def parallel(folder: Path, kind: str = "UnstructuredGrid", ending: str = ".vtu") -> list[Path]:
    """Two pieces of each moment and the file that names them."""
    files = []
    for k, frame in enumerate(frames()):
        for part in (0, 1):
            c = halves(components(frame), part)
            content = vtu_bytes(stacked(c, "x", "y", "z"), {"id": c["id"], "vel": stacked(c, "vx", "vy", "vz")},
                                frame.time)
            (folder / f"theirs_{k}_{part}{ending}").write_bytes(content.replace(b"UnstructuredGrid", kind.encode()))
        pieces = "".join(f'<Piece Source="theirs_{k}_{part}{ending}"/>' for part in (0, 1))
        files.append(folder / f"theirs_{k}.p{ending[1:]}")
        files[-1].write_text(f'<VTKFile type="P{kind}"><P{kind} GhostLevel="0"><PPoints/>{pieces}</P{kind}></VTKFile>')
    return files


def ranks(folder: Path, *names: str) -> list[Path]:
    """A file of each process for each moment, with the plain columns or others."""
    files = []
    for k, frame in enumerate(frames()):
        for part in (0, 1):
            c = halves(components(frame), part)
            files.append(folder / f"proc-{part}.{k}.npz")
            np.savez(files[-1], t=frame.time, **{name: c[name] for name in names or PLAIN})
    return files


def arrays_apart(folder: Path) -> list[Path]:
    files = []
    for k, frame in enumerate(frames()):
        c = components(frame)
        for name, columns in (("position", ("x", "y")), ("velocity", ("vx", "vy")),
                              ("stress", ("sxx", "sxy", "syx", "syy"))):
            files.append(folder / f"{name}_{k}.npz")
            np.savez(files[-1], t=frame.time, id=c["id"], **{name: stacked(c, *columns)})
    return files


def restart(folder: Path) -> list[Path]:
    """Two files of a run, both with the moment between."""
    files = []
    for k, part in enumerate((frames()[:2], frames()[1:])):
        files.append(folder / f"run_{k}.npz")
        np.savez(files[-1], t=np.array([f.time for f in part]), id=part[0].number,
                 x=np.stack([f.position for f in part]), v=np.stack([f.velocity for f in part]))
    return files


def hdf5(folder: Path) -> list[Path]:
    """The tables that CB-Geo writes."""
    import h5py
    files, names = [], {"id": "id", "coord_x": "x", "coord_y": "y", "coord_z": "z", "velocity_x": "vx",
                        "velocity_y": "vy", "velocity_z": "vz", "stress_xx": "sxx", "stress_yy": "syy",
                        "stress_zz": "szz", "tau_xy": "sxy", "tau_yz": "0", "tau_xz": "0", "status": "0"}
    for k, frame in enumerate(frames()):
        c = components(frame)
        table = np.zeros(len(c["x"]), [(name, "<i8" if name == "id" else "<f8") for name in names])
        for name, column in names.items():
            table[name] = c[column]
        files.append(folder / f"particles{k}.h5")
        with h5py.File(files[-1], "w") as file:
            file["table"] = table
            file.attrs["time"] = frame.time
    return files
