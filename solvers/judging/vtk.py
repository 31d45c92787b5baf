"""Particles in VTK's formats, read and written through meshio."""

import tempfile
from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np

from solvers.judging.columns import gathered
from solvers.judging.frames import FileError, Raw

TIMES = ("TimeValue", "TIME", "Time", "time", "t")


def read_vtk(path: str) -> Raw:
    """Points are positions, data of points the rest; the time may be among the data of the field (``TimeValue``)."""
    kind = Path(path).suffix.lower()
    try:  # with the reader itself, for meshio's own ends the process where a file is bad
        mesh = {".vtk": meshio.vtk.read, ".vtp": _polydata}.get(kind, meshio.vtu.read)(path)
    except (FileError, OSError):
        raise
    except Exception as error:  # what a broken file makes of a parser
        raise FileError(path, f"cannot be read as {Path(path).suffix} by meshio ({type(error).__name__}: {error}); "
                              "write points with data, in text or binary") from None
    named = {name: np.asarray(values) for name, values in mesh.point_data.items()}
    fields = {name: np.asarray(values).ravel() for name, values in (mesh.field_data or {}).items()}
    time = next((float(fields[name][0]) for name in TIMES if name in fields and len(fields[name])), None)
    cells = int(fields["cells"][0]) if len(fields.get("cells", ())) else None
    return gathered(path, {"points": np.asarray(mesh.points), **named}, time, cells)


def write_vtu(position: np.ndarray, data: dict[str, np.ndarray], time: float) -> bytes:
    """Points (P, D) with data (P, ...) as the content of a .vtu file."""
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


def _polydata(path: str) -> meshio.Mesh:
    """A .vtp is a .vtu with other cells: give its points to meshio as that, each a cell of its own."""
    tree = ElementTree.parse(path)
    root = tree.getroot()
    body = root.find("PolyData")
    if root.attrib.get("type") != "PolyData" or body is None:
        raise FileError(path, "is no PolyData, as a .vtp file is; give it the ending of what it is")
    root.attrib["type"], body.tag = "UnstructuredGrid", "UnstructuredGrid"
    for piece in body.findall("Piece"):
        n = int(piece.attrib["NumberOfPoints"])
        piece.attrib["NumberOfCells"] = str(n)
        for name in ("Verts", "Lines", "Strips", "Polys", "CellData"):
            for part in piece.findall(name):
                piece.remove(part)
        cells = ElementTree.SubElement(piece, "Cells")
        for name, numbers in (("connectivity", range(n)), ("offsets", range(1, n + 1)), ("types", [1] * n)):
            array = ElementTree.SubElement(cells, "DataArray", type="Int64", Name=name, format="ascii")
            array.text = " ".join(map(str, numbers))
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder, "particles.vtu")
        tree.write(target)
        return meshio.vtu.read(str(target))
