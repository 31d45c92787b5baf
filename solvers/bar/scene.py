"""BarScene: a run of the vibrating bar, its defaults and its rules."""

from __future__ import annotations

import math
from dataclasses import dataclass

from solvers.bar import validity
from solvers.remedies import CENTRED, COUPLED, FILTER, FROZEN
from solvers.rules import SceneError, require_number
from solvers.scene import Scene, option

#: Above this amplitude the exact bar turns inside out: F = 1 + 2 pi A cos(2 pi X) sin(wt) reaches 0.
BAR_AMPLITUDE_LIMIT = 1 / (2 * math.pi)


@dataclass(frozen=True)
class BarScene(Scene):
    """One run of the bar of unit length: h = 1/``cells`` (see :class:`~solvers.scene.Scene`)."""

    problem: str = option("bar", choices=("bar",))
    method: str = option("ugimp", "Shape functions of the particles", choices=("mpm", "ugimp", "cpgimp", "bspline"))
    cells: int = option(40, "Cells of the grid; h = 1 m / cells")
    ppc: int = option(4, "Particles per cell")
    amplitude: float = option(0.025, "Amplitude A of the displacement", "m")
    modulus: float = option(4.0, "Young's modulus E", "Pa")
    density: float = option(1.0, "Density", "kg/m3")
    body_force: str = option(
        "material", "Body force: at material points, at nodes, none, or two tones that have no built-in solution",
        choices=("material", "node", "none", "two-tone"))
    velocity: str = option("grid", "Velocity that moves the particles (corners: cpgimp only)",
                           choices=("grid", "particle", "corners"))

    TITLE = "vibrating bar"
    SETTING = "The bar is 1 m long."
    EXTRA_ERROR = "sigma_log"
    VALIDITY = validity.RULES
    REMEDIES = (FILTER, COUPLED, CENTRED, FROZEN)
    STRAIN_PER_AMPLITUDE = 1 / BAR_AMPLITUDE_LIMIT
    GENTLE_AMPLITUDE = 1e-3
    HARD_AMPLITUDES = (0.025, 0.05, 0.1, 0.14)

    @classmethod
    def candidates(cls) -> tuple[tuple[str, bool], ...]:
        """uGIMP with linearity preservation too."""
        return (*super().candidates(), ("ugimp", True))

    @property
    def spacing(self) -> float:
        """Cell size h."""
        return 1.0 / self.cells

    @property
    def particles(self) -> int:
        return self.cells * self.ppc

    @property
    def angular_frequency(self) -> float:
        """w of the exact solution: c pi/l with the body force (eq 32), the natural 2 c pi/l without; l = 1."""
        return self.wave_speed * math.pi * (2 if self.body_force == "none" else 1)

    @property
    def motion_amplitude(self) -> float:
        """Largest displacement of the exact solution: A; A/2 for the free bar, which starts at the same speed."""
        return self.amplitude / 2 if self.body_force == "none" else self.amplitude

    def warnings(self) -> list[str]:
        sentences = super().warnings()
        if "two-grid" in self.active_estimators and validity.noisy(self):
            sentences.append("two-grid says nothing of a here: particles that cross cells fill it with noise, which "
                             "each of the two grids has in other places")
        return sentences

    def _check_amplitude(self) -> None:
        allowed = "give a number above 1e-12 and below 0.159"
        require_number("amplitude", self.amplitude, 1e-12, math.inf, allowed)
        if self.amplitude >= BAR_AMPLITUDE_LIMIT:
            raise SceneError("amplitude", self.amplitude, f"the exact bar inverts from 1/(2 pi) = 0.159 on; {allowed}")

    def _check_combinations(self) -> None:
        if self.velocity == "corners" and self.method != "cpgimp":
            raise SceneError("velocity", "corners", "moves the corners of convected domains and needs "
                             "the method cpgimp; with other methods give grid or particle")
        if self.frozen:
            self._check_frozen()

    def _check_frozen(self) -> None:
        """Frozen weights have nothing to correct: they see the material at rest, where it fills the grid evenly."""
        others = [name for name in self.remedies if name != FROZEN]
        if others:
            raise SceneError("remedies", " ".join(self.remedies), f"frozen-weights stands alone: {others[0]} mends "
                             "what comes of particles that move through the grid; leave one of the two out")
        for name, value, plain in (("linearity_preserving", self.linearity_preserving, False),
                                   ("body_force", self.body_force == "node", False),
                                   ("velocity", self.velocity == "corners", False)):
            if value != plain:
                raise SceneError(name, getattr(self, name), "does not go with frozen-weights, whose particles do not "
                                 "move through the grid; leave one of the two out")
