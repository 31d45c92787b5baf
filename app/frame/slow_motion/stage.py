"""Slow motion common to all problems: how each phase of a step is drawn around one particle."""

from abc import ABC, abstractmethod
from dataclasses import replace

import numpy as np

from app.frame.layout import Rectangle, drawing_rectangle
from app.frame.primitives import Anchor, Colour, StageMetrics, Surface, wrap_text
from app.frame.slow_motion.sketch import SIZES, Sketch
from app.frame.slow_motion.step_phases import PHASES, format_scaled
from app.language.translation import tr
from solvers.scene.scene import Scene
from solvers.solver.particle_step_breakdown import ParticleStepBreakdown

#: Colours: the selected particle, the others, their domains, internal and body forces, nodes.
FRONT, OTHERS, DOMAINS = (0, 158, 115), (120, 127, 136), (205, 210, 216)
STRESS, BODY, NODE = (213, 94, 0), (0, 114, 178), (24, 28, 34)
HIGH = (0.3, 0.9)  # least and greatest height of the stage
#: Possible positions of a node's numbers: anchor and direction.
SIDES: tuple[tuple[Anchor, tuple[int, int]], ...] = (
    ("bottom-center", (0, 1)), ("top-center", (0, -1)), ("center-left", (1, 0)), ("center-right", (-1, 0)),
    ("bottom-left", (1, 1)), ("bottom-right", (-1, 1)), ("top-left", (1, -1)), ("top-right", (-1, -1)))
DIGITS = {1: 5, 2: 4}  # of numbers beside the nodes, by dimensions
LONGEST = 0.42  # longest arrow in cells
WIDEST = 0.3  # largest square of a node in cells
THICKEST = 9.0  # pixels of a line of weight one
MAGNIFIED = 0.3  # approximate drawn displacement of particles in cells


class SlowMotionStage(ABC):
    """Stage that draws the phases of one step around a selected particle on the surface ``sheet``; subclasses define
    where particles and nodes are drawn. Common arguments: ``a`` is the breakdown of the step, ``s`` the progress of the
    phase from 0 to 1."""

    def __init__(self, sheet: Surface):
        self.sheet, self._sketch = sheet, Sketch()
        self._lay_out()

    @property
    def rectangle(self) -> Rectangle:
        """Rectangle of everything drawn: x0, x1, y0, y1 in stage coordinates."""
        return drawing_rectangle(self._stage_metrics.high)

    def _lay_out(self) -> None:
        """Divides the surface's present bounds between text and picture."""
        metrics = self.sheet.stage_metrics.rounded()
        self._stage_metrics = replace(metrics, high=min(max(metrics.high, HIGH[0]), HIGH[1]))
        self._words, self._picture = self._split_text_and_picture(self._stage_metrics)

    def draw(self, scene: Scene, a: ParticleStepBreakdown, phase: int, s: float) -> None:
        """Draws one phase, with an index into ``PHASES``, of the step ``a`` of a scene's run, at the progress ``s``
        from 0 at the beginning of the phase to 1 at its end."""
        self._lay_out()
        self._fit_step_in_picture(a)
        self._nodes = self._node_spots(a.nodes)
        self._scale = self._per_metre * a.spacing  # a cell, on the stage
        self._legend: list[str] = []
        shift = a.after.position - a.before.position  # magnified to be visible
        moved = max(1.0, _round(MAGNIFIED * a.spacing / max(np.abs(shift).max(), 1e-300)))
        progress = {4: max(0.0, 2 * s - 1), 5: 1.0}.get(phase, 0.0)
        self._places = a.place + moved * progress * shift
        self._spots = self._particle_spots(self._places)
        self._draw_cells(a)
        if phase < 5:
            seen = self._is_inside(self._spots, self._per_metre * float(np.abs(a.edges).sum(axis=1).max()))
            self._draw_domains(self._places[seen], a.edges[seen], DOMAINS, 1.0)
            self._draw_domains(self._places[:1], a.edges[:1], FRONT, 2.0)
        draw = (self._draw_functions_phase, self._draw_particles_to_nodes, self._draw_forces, self._draw_velocities,
                self._draw_nodes_to_particles, self._draw_strain)[phase]
        draw(scene, a, s)
        if phase >= 4 and moved > 1:
            self._legend.append(tr("particles' way drawn × {factor:g}", factor=moved))
        self._sketch.dots(self._spots[1:][self._is_inside(self._spots[1:])], OTHERS, 1)
        self._sketch.dots(self._spots[:1], FRONT, 2)
        self._sketch.dots(self._nodes, NODE, 0)
        self._write_node_numbers(a, phase)
        which = tr("Particle {particle} in step {step}", particle=a.particle, step=a.step)
        caption = "\n".join(wrap_text(line, self.letters_per_caption_line)
                            for line in [which, *PHASES[phase].front(scene, a)])
        self._sketch.text(0.0, self._stage_metrics.high,
                          wrap_text("; ".join(self._legend), self.letters_per_caption_line), "top-left")
        self._sketch.text(0.0, 0.0, caption, "bottom-left")
        self.sheet.show_marks(*self._sketch.marks())

    def _draw_functions_phase(self, scene: Scene, a: ParticleStepBreakdown, s: float) -> None:
        self._draw_shape_functions(scene, a, s)
        self._draw_weight_lines(a, FRONT, s)
        self._legend.append(tr("green: the particle; its lines to nodes are as thick as the weight"))

    def _draw_particles_to_nodes(self, _: Scene, a: ParticleStepBreakdown, s: float) -> None:
        """Draws parcels on their way from particles to nodes, whose squares grow; the selected particle's are green."""
        self._draw_weight_lines(a, FRONT, 1.0)
        self._draw_parcels(a, s, slice(None))
        most = a.node_mass.max()
        for mass, colour, thickness in ((a.node_mass, NODE, 2.0), (a.links.weight[0] * a.mass[0], FRONT, 3.5)):
            half = 0.5 * WIDEST * self._scale * np.sqrt(s * np.maximum(mass, 0) / most)
            corners = self._nodes[:, None] + half[:, None, None] * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
            self._sketch.outline(corners, colour, thickness)
        seen = self._is_inside(self._spots)
        self._draw_arrows(self._spots[seen], a.before.velocity[seen], OTHERS)
        self._draw_arrows(self._nodes, s * a.momentum, NODE, a.momentum)
        self._legend.append(tr("squares: mass of the nodes (green: from the particle); arrows: v of particles, "
                               "momentum"))

    def _draw_forces(self, _: Scene, a: ParticleStepBreakdown, s: float) -> None:
        self._draw_weight_lines(a, FRONT, 1.0)
        both = np.concatenate([a.internal_force, a.body_force])
        self._draw_arrows(self._nodes, s * a.internal_force, STRESS, both, 3.5)
        self._draw_arrows(self._nodes - 0.05 * self._scale * self._aside, s * a.body_force, BODY, both, 3.5)
        self._legend.append(tr("orange: force of stress; blue: body force"))

    def _draw_velocities(self, _: Scene, a: ParticleStepBreakdown, s: float) -> None:
        """Draws velocities, and their changes on a larger scale of their own."""
        old, gained = a.before_velocity, a.velocity - a.before_velocity
        factor = _round(np.abs(a.velocity).max() / max(np.abs(gained).max(), 1e-300))
        self._draw_arrows(self._nodes, old, OTHERS, np.concatenate([old, a.velocity]), 2.0)
        self._draw_arrows(self._nodes, old + s * gained, NODE, np.concatenate([old, a.velocity]), 3.5)
        self._draw_arrows(self._nodes - 0.07 * self._scale * self._aside, s * gained, STRESS, gained, 3.5)
        self._legend.append(tr("grey: old v; black: new v; orange: what is gained, drawn × {factor:g}", factor=factor))

    def _draw_nodes_to_particles(self, _: Scene, a: ParticleStepBreakdown, s: float) -> None:
        """Draws parcels on their way back in the first half of the phase, moving particles in the second."""
        self._draw_weight_lines(a, FRONT, 1.0)
        self._draw_arrows(self._nodes, a.velocity, NODE)
        if s < 0.5:
            self._draw_parcels(a, 1 - 2 * s, slice(0, 1))
        else:
            start = self._particle_spots(a.place)
            seen = self._is_inside(start) & self._is_inside(self._spots)
            self._sketch.line(start[seen], self._spots[seen], OTHERS, 2.0)
            self._sketch.dots(start[seen], DOMAINS, 1)
        self._legend.append(tr("black: new v of the nodes"))

    def _draw_strain(self, _: Scene, a: ParticleStepBreakdown, s: float) -> None:
        """Draws the selected particle's domain as it deforms, magnified."""
        self._draw_weight_lines(a, FRONT, 1.0)
        self._draw_arrows(self._nodes, a.velocity, NODE)
        F = a.before.deformation_gradient[0]
        gained = a.after.deformation_gradient[0] @ np.linalg.pinv(F) - np.eye(len(F))
        factor = _round(0.5 / max(np.abs(gained).max(), 1e-300))
        edges = a.edges[0] if np.abs(a.edges[0]).max() > 0 else 0.25 * a.spacing * np.eye(len(F))
        for share, colour, thickness in ((0.0, OTHERS, 1.0), (s * factor, FRONT, 3.5)):
            self._draw_domains(self._places[:1], (edges @ (np.eye(len(F)) + share * gained).T)[None], colour, thickness)
        self._legend.append(tr("outline: the particle's material before and after, its strain in this step × "
                               "{factor:g}", factor=factor))

    def _draw_weight_lines(self, a: ParticleStepBreakdown, colour: Colour, s: float) -> None:
        """Draws lines, as thick as the weights, from the selected particle along ``s`` of the way to its nodes."""
        start = np.broadcast_to(self._spots[:1], self._nodes.shape)
        self._sketch.line(start, start + s * (self._nodes - start), colour, THICKEST * a.links.weight[0])

    def _draw_parcels(self, a: ParticleStepBreakdown, s: float, members: slice) -> None:
        """Draws parcels, ``s`` of their way from the particles ``members`` to nodes with a nonzero weight."""
        k, n = np.nonzero(a.links.weight[members])
        start, end = self._picture_entry_points(self._spots[k], self._nodes[n]), self._nodes[n]
        if len(self._spots[members]) > 1:
            self._sketch.line(start[k > 0], end[k > 0], DOMAINS, 1.0)
        if 0 < s < 1:
            at = start + s * (end - start)
            self._sketch.dots(at[k > 0], OTHERS, 0)
            self._sketch.dots(at[k == 0], FRONT, 1)

    def _draw_arrows(self, at: np.ndarray, vectors: np.ndarray, colour: Colour,
                     among: np.ndarray | None = None, thickness: float = 2.0) -> None:
        """Draws arrows at points (m, 2) of the stage for vectors (m, D) in any unit; the longest of ``among``, by
        default of the vectors, is drawn ``LONGEST`` cells long."""
        most = np.hypot.reduce(vectors if among is None else among, axis=1).max()
        if most > 0:
            self._sketch.arrow(at, LONGEST * self._scale / most * self._stage_vectors(vectors), colour, thickness)

    def _write_node_numbers(self, a: ParticleStepBreakdown, phase: int) -> None:
        """Writes the solver's numbers of a phase (its index) beside each node, on the side away from its arrows."""
        shown = PHASES[phase].columns[:PHASES[phase].drawn]
        digits = DIGITS[a.nodes.shape[1]]
        texts, units = zip(*(format_scaled(c.scale * c.values(a), c.unit, digits) for c in shown), strict=True)
        arrows = [c.values(a) for c in shown] + [a.velocity - a.before_velocity] * (phase == 3)
        taken = np.max([self._stage_vectors(values / max(np.abs(values).max(),
                                                         1e-300)) @ np.array([side for _, side in SIDES]).T
                        if values.ndim > 1 else np.zeros((len(self._nodes), len(SIDES))) for values in arrows], axis=0)
        away = self._above + 0.5 * WIDEST * self._scale * (phase == 1)
        written: list[tuple[np.ndarray, np.ndarray]] = []
        for spot, reaching, *parts in zip(self._nodes, taken, *texts, strict=True):
            text = "\n".join(parts)
            anchor, side = SIDES[self._free_side(spot, away, text, reaching, written)]
            x, y = spot + away * np.array(side)
            self._sketch.text(x, y, text, anchor)
        names = [tr("{name} in {unit}", name=tr(c.name), unit=unit) if unit else tr(c.name)
                 for c, unit in zip(shown, units, strict=True)]
        self._legend.insert(0, tr("numbers at the nodes: {first}, below it {second}", first=names[0], second=names[1])
                            if len(names) > 1 else tr("numbers at the nodes: {first}", first=names[0]))

    def _free_side(self, spot: np.ndarray, away: float, text: str, taken: np.ndarray,
                   written: list[tuple[np.ndarray, np.ndarray]]) -> int:
        """Returns the index in ``SIDES`` of the side of a node for the ``text`` of its numbers, ``away`` from its
        ``spot`` (2,): never over the selected particle, not along arrows, which extend by ``taken`` (8,) to the sides,
        and off the labels ``written`` so far (middles and half sizes; the new one is appended)."""
        half = 0.5 * self._stage_metrics.text_extent(text)
        middles = spot + np.array([side for _, side in SIDES]) * (away + half)
        front = np.all(np.abs(self._spots[0] - middles) < half + 0.5 * SIZES[2], axis=1)
        others = sum((np.all(np.abs(at - middles) < half + size, axis=1) for at, size in written), np.zeros(len(SIDES)))
        best = int((taken + 10 * others + 1000 * front).argmin())
        written.append((middles[best], half))
        return best

    @property
    def letters_per_caption_line(self) -> int:
        """Number of letters that fit into a line of the captions."""
        return self._stage_metrics.letters_per_line(self._words)

    def _is_inside(self, spots: np.ndarray, reach: float = 0.0) -> np.ndarray:
        """Returns which points (m, 2) of the stage are in the picture and at least ``reach`` off its edges, (m,)."""
        x0, x1, y0, y1 = self._picture
        return np.all((spots - reach >= (x0, y0)) & (spots + reach <= (x1, y1)), axis=1)

    def _picture_entry_points(self, starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
        """Returns points (m, 2) where lines from starts (m, 2) to ends (m, 2) in the picture enter, or begin in, it."""
        x0, x1, y0, y1 = self._picture
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(starts < (x0, y0), ((x0, y0) - starts) / (ends - starts),
                             np.where(starts > (x1, y1), ((x1, y1) - starts) / (ends - starts), 0.0)).max(axis=1)
        return starts + share[:, None] * (ends - starts)

    #: Height of a node's number above it, and direction across its arrows.
    _above: float
    _aside: np.ndarray
    _per_metre: float

    @abstractmethod
    def _split_text_and_picture(self, metrics: StageMetrics) -> tuple[float, Rectangle]:
        """Returns the width of lines of text and the picture's x0, x1, y0, y1, all in stage coordinates."""

    @abstractmethod
    def _fit_step_in_picture(self, a: ParticleStepBreakdown) -> None:
        """Sets ``_per_metre``, the stage length of a metre, and the picture's position so that all of it is visible."""

    @abstractmethod
    def _particle_spots(self, x: np.ndarray) -> np.ndarray:
        """Returns points (k, 2) of the stage for particles at x (k, D) in m."""

    @abstractmethod
    def _node_spots(self, x: np.ndarray) -> np.ndarray:
        """Returns points (n, 2) of the stage for nodes at x (n, D) in m."""

    @abstractmethod
    def _stage_vectors(self, vectors: np.ndarray) -> np.ndarray:
        """Returns vectors (m, D), in any unit, as vectors (m, 2) in the directions of the stage, of the same length."""

    @abstractmethod
    def _draw_domains(self, x: np.ndarray, edges: np.ndarray, colour: Colour, thickness: float) -> None:
        """Draws domains of particles at x (k, D) with half edge vectors (k, D, D), in m; the thickness is in pixels."""

    @abstractmethod
    def _draw_cells(self, a: ParticleStepBreakdown) -> None:
        """Draws the edges of the cells around the selected particle."""

    @abstractmethod
    def _draw_shape_functions(self, scene: Scene, a: ParticleStepBreakdown, s: float) -> None:
        """Draws the shape functions of the selected particle's nodes, ``s`` times as high as their values."""


def averaged_hat(distance: np.ndarray, half_width: float) -> np.ndarray:
    """Returns the hat function at a distance (n,) from its node, both in cells, averaged over ``half_width`` cells to
    either side; with 1/2 the average is the quadratic B-spline."""
    if half_width < 1e-9:
        return np.maximum(0.0, 1 - np.abs(distance))

    def integral(x: np.ndarray) -> np.ndarray:
        x = np.clip(x, -1, 1)
        return x - 0.5 * x * np.abs(x)

    return (integral(distance + half_width) - integral(distance - half_width)) / (2 * half_width)


def _round(factor: float) -> float:
    """Returns ``factor`` rounded down to 1, 2, 5, 10, 20, ...; 1 for smaller and for huge or non-finite ones."""
    if not 1 < factor < 1e15:
        return 1.0
    power = 10.0 ** np.floor(np.log10(factor))
    return float(power * max(m for m in (1, 2, 5) if m * power <= factor * (1 + 1e-12)))
