"""Words: names, units, symbols and number formats, for the command line, the page and every picture."""

from __future__ import annotations

from solvers.rules import field_key
from solvers.scene import Scene


def command_line(scene: Scene) -> str:
    """The command that runs the scene, with what differs from the defaults."""
    kind, words = type(scene), [f"mpm-lab run {scene.problem} --method {scene.method} --cells {scene.cells}",
                                f"--ppc {scene.ppc} --cfl {scene.courant_number:g}"]
    for field in ("amplitude", "modulus", "density", "t_end", "periods", "body_force"):
        if getattr(scene, field) != getattr(kind, field):
            words.append(f"--{field_key(field).replace('_', '-')} {getattr(scene, field)}")
    if scene.linearity_preserving:
        words.append("--linearity-preserving")
    return " ".join(words)


