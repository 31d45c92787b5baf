"""The script that the viewer's page unpacks and runs: a browser that runs no others must know it beforehand."""

import re

import numpy as np
import zstandard

_DIGITS = "!#$%()*+,-./0123456789:;=?@ABCDEFGHIJKLMNOPQRSTUVWXYZ[\\]^_abcdefghijklmnopqrstuvwxyz{|}~"
_GROUP, _BYTES = 5, 4  # five digits, of as many kinds as there are above, are four bytes
_PACKED = re.compile(r'<script data-p="([^"]*)" data-ss="(\d+)" data-cs="(\d+)">')


def unpacked_script(html: str) -> str | None:
    """The script in the viewer's html; None where that is not packed as in 1.1."""
    found = _PACKED.search(html)
    if found is None:
        return None
    style, script = int(found[2]), int(found[3])
    whole = zstandard.ZstdDecompressor().decompress(_bytes(found[1]), max_output_size=style + script)
    return whole[style:style + script].decode("utf-8")


def _bytes(text: str) -> bytes:
    """What the digits mean; a group that is not whole is a byte shorter than it has digits."""
    value = np.zeros(128, dtype=np.int64)
    value[[ord(digit) for digit in _DIGITS]] = range(len(_DIGITS))
    digits = value[np.frombuffer(text.encode("ascii"), dtype=np.uint8)]
    whole = len(digits) // _GROUP * _GROUP
    groups = digits[:whole].reshape(-1, _GROUP) @ len(_DIGITS) ** np.arange(_GROUP)[::-1]
    rest = 0
    for digit in digits[whole:]:
        rest = rest * len(_DIGITS) + int(digit)
    return groups.astype(f">u{_BYTES}").tobytes() + rest.to_bytes(max(0, len(digits) - whole - 1), "big")
