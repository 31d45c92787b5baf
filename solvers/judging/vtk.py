"""Particles in VTK's formats: which reader a file needs, and a file as we write it."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from solvers.judging.columns import gathered
from solvers.judging.frames import Raw
from solvers.judging.vtk_legacy import read_legacy
from solvers.judging.vtk_parts import NotVTK, Points
from solvers.judging.vtk_xml import read_xml
from solvers.outside.file_error import FileError
from solvers.outside.limits import LIMITS, Limits

LARGEST = 250_000_000  # bytes of such a file: its text is in memory once, and what it says
OF_KIND = {".vtu": "UnstructuredGrid", ".vtp": "PolyData"}
TIMES = ("TimeValue", "TIME", "Time", "time", "t")


def read_vtk(path: str, limits: Limits = LIMITS) -> Raw:
    """Points are positions, data of points the rest; the time may be among the data of the field (``TimeValue``)."""
    kind = Path(path).suffix.lower()
    with open(path, "rb") as file:
        if (size := file.seek(0, 2)) > LARGEST:
            raise FileError(path, f"has {size / 1e6:,.0f} MB; give at most {LARGEST / 1e6:,.0f} MB of this kind, with "
                                  "fewer data for example, or a .npz")
        file.seek(0)
        found = Points(path, limits)
        try:
            read_legacy(file, found) if kind == ".vtk" else read_xml(file, OF_KIND[kind], kind, found)
        except (FileError, OSError):
            raise
        except Exception as error:  # what a broken file makes of a parser
            why = str(error) if isinstance(error, NotVTK) else type(error).__name__
            raise FileError(path, f"cannot be read as {kind} ({why}); write points with data, in text or "
                                  "binary") from None
    fields = found.fields
    time = next((float(fields[name][0]) for name in TIMES if len(fields.get(name, ()))), None)
    cells = float(fields["cells"][0]) if len(fields.get("cells", ())) else None
    if cells is not None and not cells.is_integer():
        raise FileError(path, f"says that it has {cells} cells; give a whole number")
    return gathered(path, found.columns(), time, None if cells is None else int(cells), limits)


def write_vtu(position: np.ndarray, data: dict[str, np.ndarray], time: float) -> bytes:
    """Points (P, D) with data (P, ...) as the content of a .vtu file."""
    import meshio  # here: reading does without

    points = np.zeros((len(position), 3))
    points[:, :position.shape[1]] = position
    mesh = meshio.Mesh(points, [("vertex", np.arange(len(points))[:, None])], point_data=data)
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder, "particles.vtu")
        meshio.vtu.write(str(target), mesh, binary=True)
        text = target.read_text(encoding="utf-8")
    stamp = ('<FieldData><DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">'
             f"{time!r}</DataArray></FieldData>")
    return text.replace("<UnstructuredGrid>", f"<UnstructuredGrid>{stamp}", 1).encode()
