"""What a visitor can choose from, problem by problem: words for codes, and the reach of the sliders."""

from __future__ import annotations

from dataclasses import dataclass

PROBLEMS = {"bar": "vibrating bar", "ring": "expanding ring"}
METHODS = {"mpm": "MPM (hat functions)", "ugimp": "uGIMP", "cpgimp": "cpGIMP", "bspline": "B-spline", "cpdi": "CPDI"}
#: Label, key in samples, unit. The order is that of the error columns.
QUANTITIES = {"displacement x": ("x", "m"), "velocity v": ("v", "m/s"), "stress σ": ("sigma", "Pa"),
              "acceleration a": ("a", "m/s²")}
SYMBOLS = {"x": "x", "v": "v", "sigma": "σ", "a": "a"}
BODY_FORCES = {"material": "at the particles", "node": "at the nodes", "none": "none",
               "two-tone": "two-tone: no exact solution known"}
VELOCITIES = {"grid": "grid velocity", "particle": "particle velocity", "corners": "domain corners"}
LAYOUTS = {"polar": "polar", "cartesian": "Cartesian"}
EFFECTS = {"truth": "true error", "estimate": "estimate", "crossings": "grid crossings", "energy": "energy",
           "acceleration": "acceleration error"}


@dataclass(frozen=True)
class Reach:
    """Ends of a problem's sliders: whole numbers (low, high, step), and (low, high) of those whose steps are factors.

    Some reach beyond what a scene can be: the page then says why not, and that is worth reading.
    """

    cells: tuple[int, int, int]
    ppc: tuple[int, int]
    amplitude: tuple[float, float]
    modulus: tuple[float, float]
    speed: tuple[float, float]
    length: str  # the length that ``cells`` divide, for the label of h
    amplitude_hint: str


REACH = {
    "bar": Reach((8, 160, 1), (1, 8), (1e-4, 0.2), (1.0, 1000.0), (1e-3, 4.0), "1",
                 "amplitude of the vibration; from 0.159 m on the exact bar turns inside out"),
    "ring": Reach((12, 96, 6), (1, 6), (1e-3, 0.4), (1e5, 1e8), (1e-5, 0.1), "1.2",
                  "largest displacement of the outer rim; above 0.198 m a real ring wrinkles, from 0.386 m on the "
                  "exact one turns inside out"),
}
CFL = (0.01, 2.0)
