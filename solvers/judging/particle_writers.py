"""Writers of particles in the judge's formats: initial ones, exact ones, and those of our runs."""

import base64
import io
import struct
import zlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from solvers.judging.particle_data_types import Frame
from solvers.judging.quantity_names import output_column_names
from solvers.running.result_file import particle_arrays
from solvers.scene.scene import Scene

FRAME_FIELDS = {"X": "material_position", "x": "position", "v": "velocity", "F": "deformation_gradient",
                "sigma": "stress"}


def frame_columns(frames: Sequence[Frame], more: Mapping[str, np.ndarray] | None = None) -> dict[str, np.ndarray]:
    """Returns columns (n,) by name, with the rows of all frames: t, id, the frames' fields, and ``more``."""
    columns = {"t": np.concatenate([np.full(len(f.number), f.time) for f in frames]),
               "id": np.concatenate([f.number for f in frames])}
    D = frames[0].position.shape[1]
    for key, name in FRAME_FIELDS.items():
        if any(getattr(f, name) is None for f in frames):
            continue
        values = np.concatenate([getattr(f, name) for f in frames])
        columns |= dict(zip(output_column_names(key, D), values.reshape(len(values), -1).T, strict=True))
    return columns | dict(more or {})


def csv_text(columns: Mapping[str, np.ndarray], comments: Mapping[str, object] | None = None) -> bytes:
    """Returns columns (n,) as a CSV file, numbers to their last bit, after lines ``# name = value`` of ``comments``."""
    out = io.StringIO()
    out.writelines(f"# {name} = {value}\n" for name, value in (comments or {}).items())
    out.write(",".join(columns) + "\n")
    texts = [map(str if values.dtype.kind in "iu" else repr, values.tolist()) for values in columns.values()]
    out.writelines(",".join(row) + "\n" for row in zip(*texts, strict=True))
    return out.getvalue().encode()


def npz_bytes(frames: Sequence[Frame], scene: Scene, more: Mapping[str, Any] | None = None) -> bytes:
    """Returns frames of the same particles as a .npz file: arrays (T, P, ...), their scene, and ``more`` arrays."""
    x, v, F = (np.stack([getattr(f, FRAME_FIELDS[key]) for f in frames]) for key in ("x", "v", "F"))
    arrays = particle_arrays(scene, [f.time for f in frames], frames[0].number, frames[0].material_position, x, v, F)
    out = io.BytesIO()
    np.savez_compressed(out, **arrays | dict(more or {}))
    return out.getvalue()


def vtu_bytes(position: np.ndarray, data: Mapping[str, np.ndarray], time: float) -> bytes:
    """Returns points (P, D) in m with data (P, ...) and the time in s as a .vtu file, each array one packed block."""
    P, D = position.shape
    points = np.pad(position, ((0, 0), (0, 3 - D)))
    vertices = {"connectivity": np.arange(P), "offsets": np.arange(1, P + 1), "types": np.ones(P, np.uint8)}
    stamp = f'<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{time!r}</DataArray>'
    parts = [("Points", {"Points": points}), ("Cells", vertices), ("PointData", data)]
    body = "".join(f"<{name}>{''.join(_data_array_xml(key, values) for key, values in arrays.items())}</{name}>"
                   for name, arrays in parts)
    return (f'<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
            f'header_type="UInt64" compressor="vtkZLibDataCompressor"><UnstructuredGrid><FieldData>{stamp}</FieldData>'
            f'<Piece NumberOfPoints="{P}" NumberOfCells="{P}">{body}</Piece></UnstructuredGrid></VTKFile>\n').encode()


def _data_array_xml(name: str, values: np.ndarray) -> str:
    letter, size = values.dtype.kind, 8 * values.dtype.itemsize
    content = values.astype(values.dtype.newbyteorder("<")).tobytes()
    packed = zlib.compress(content)
    head = struct.pack("<4Q", 1, len(content), 0, len(packed))
    text = (base64.b64encode(head) + base64.b64encode(packed)).decode()
    return (f'<DataArray type="{ {"i": "Int", "u": "UInt", "f": "Float"}[letter]}{size}" Name="{name}" '
            f'NumberOfComponents="{values[:1].size}" format="binary">{text}</DataArray>')
