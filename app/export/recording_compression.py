"""Compact encoding of a recording's numbers: each track is quantised to 8 or 16 bits, then differenced, then zlib.

A track has one row per picture. Its ``kind`` is its encoding:

* ``size``: 8 bits, from 0 to the row's largest, 254; 255 is NaN. The error is at most 1/508 of the row's largest.
* ``signed``: 8 bits, -127 to 127 for the row's largest size; -128 is NaN. The error is at most 1/254 of it.
* ``place``: 16 bits, -32767 to 32767 for the largest size in the whole track; -32768 is NaN.
* ``number``: float32, unchanged; values beyond its range are infinite.

Rows of integers are stored as differences from the row before, modulo 256 or 65536, which are small for slow motions;
16 bits as all low bytes, then all high ones."""

import zlib
from dataclasses import dataclass

import numpy as np

SIZE, SIGNED, PLACE, NUMBER = "size", "signed", "place", "number"
MOST = 1e30  # largest size, within the range of float32
TOPS = {SIZE: 254, SIGNED: 127, PLACE: 32767}
NONE = {SIZE: 255, SIGNED: -128, PLACE: -32768}
BYTES = {SIZE: 1, SIGNED: 1, PLACE: 2}
CODES = {kind: {"top": top, "none": NONE[kind], "bytes": BYTES[kind]} for kind, top in TOPS.items()}  # for the player


@dataclass(frozen=True)
class Track:
    """Array of a recording: ``values`` (rows, width) in SI units, usually a row per picture, encoded as ``kind``."""

    name: str
    kind: str
    values: np.ndarray

    @property
    def header(self) -> dict[str, str | int]:
        """The metadata that the player needs to decode the track: name, kind, rows, width."""
        return {"name": self.name, "kind": self.kind, "rows": len(self.values), "width": self.values.shape[1]}


def pack_tracks(tracks: list[Track]) -> bytes:
    """Returns the encoded tracks, concatenated in this order and compressed by zlib."""
    return zlib.compress(b"".join(map(_track_bytes, tracks)), 9)


def _track_bytes(track: Track) -> bytes:
    """Returns an encoded track: float32 scales (one per row; for ``place`` one), then codes; or float32 numbers."""
    values = np.asarray(track.values, float)
    with np.errstate(invalid="ignore", over="ignore", under="ignore"):
        if track.kind == NUMBER:
            return values.astype("<f4").tobytes()
        values = np.where(np.isfinite(values), np.clip(values, -MOST, MOST), np.nan)
        sizes = np.nan_to_num(np.abs(values))
        scales = (sizes.max(initial=0.0) if track.kind == PLACE else sizes.max(axis=1, initial=0.0)).astype("<f4")
        over = np.where(scales > 0, scales, 1.0).reshape(-1, 1)
        top = TOPS[track.kind]  # rounding of the scale to float32 must not exceed it
        codes = np.clip(np.rint(top * values / over), -top, top)
        codes = np.where(np.isfinite(values), codes, NONE[track.kind])
    whole: np.ndarray = codes.astype(np.int32)
    bits = 8 * BYTES[track.kind]
    steps = np.diff(whole, axis=0, prepend=0) % (1 << bits)
    planes = [steps & 255, steps >> 8] if bits == 16 else [steps]  # the low bytes of all, then the high ones
    return scales.tobytes() + b"".join(plane.astype(np.uint8).tobytes() for plane in planes)
