"""Check of the stress in the files against the problem's law for their F, and explanations where they differ."""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from solvers.judging.error_norms import rms
from solvers.judging.findings import findings_input, time_series_fitting
from solvers.judging.findings.finding import HOLDS, OFF, Finding, unknown
from solvers.judging.findings.findings_input import FindingsInput, ParticleTrajectories, sample_numbers
from solvers.judging.findings.time_series_fitting import interpolate_before, time_derivative
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.translatable_message import Message

NAME = "stress against the law of the material"
UNIT = "of the stress"
OTHER_LAW = 1e-3  # of the run's stress: a file whose stress is farther from what its F gives has another law
ROUNDINGS = 2.0  # times what rounding makes of it may be off
EXPLAINS = 0.3  # of the difference, at most, is left by what explains it
RATIOS = np.linspace(0.0, 0.49, 50)  # candidates of Poisson's ratio


def check_constitutive_law(evidence: FindingsInput) -> Finding:
    """Checks the stress of all frames against the problem's law for their F, relative to the run's RMS stress."""
    scene, frames = evidence.scene, evidence.frames
    both = [(f.deformation_gradient, f.stress) for f in frames
            if f.stress is not None and f.deformation_gradient is not None]
    if not both:
        return unknown(NAME, "the files do not have both F and the stress: another material shows in the motion alone, "
                             "or not at all")
    stress, law = PROBLEMS[scene.problem].reference.stress, []
    figures_F, figures_sigma = (findings_input.detect_precision(sample_numbers(values))
                                for values in zip(*both, strict=True))
    off, rounding = [], []
    chance = np.random.default_rng(0)
    for F, sigma in both:
        own = stress(scene, F)
        if not np.isfinite(own).all():
            return unknown(NAME, "some F turn the material inside out, so that there is no stress by the law")
        law.append(rms(own))
        off.append(rms(sigma - own))
        nudged = F + chance.choice([-1.0, 1.0], F.shape) * figures_F.rounding(F)
        rounding.append(rms(stress(scene, nudged) - own) + rms(figures_sigma.rounding(sigma)))
    size = float(np.sqrt(np.mean(np.square(law))))
    measured, tolerance = max(off) / size if size > 0 else np.nan, OTHER_LAW + ROUNDINGS * max(rounding) / (size or 1)
    if not np.isfinite(measured + tolerance):
        return unknown(NAME, "there is no stress by the law, or it is too large")
    if measured <= tolerance:
        return Finding(NAME, HOLDS, measured, tolerance, UNIT)
    told = _explain_stress(evidence, size) or Message("another material, or another measure of stress")
    return Finding(NAME, OFF, measured, tolerance, UNIT,
                   Message("the stress in the files is up to {measured:.2g} of the run's stress off what their F gives "
                           "by the problem's law: {told}", measured, told))


def _explain_stress(evidence: FindingsInput, size: float) -> str | None:
    """Returns in words what the stress is, where that fits far better than the problem's law; otherwise None. ``size``
    is the run's RMS stress in Pa."""
    tracks = evidence.tracks
    if tracks is None or "stress" not in tracks.own or "F" not in tracks.own:
        return None
    scene, sigma = evidence.scene, tracks.own["stress"]
    law = _stress_of_law(scene, tracks)
    before = time_series_fitting.rms(sigma - law)
    if max(map(time_series_fitting.rms, sigma - law)) <= OTHER_LAW * size:
        return None  # of large bodies not all particles are followed, and those that are off need not be
    found = [(time_series_fitting.rms(rest) / before, words)
             for rest, words in _candidates(scene, tracks, sigma, law, evidence.step)]
    left, words = min(found, key=lambda one: one[0])
    return Message("{words}, which leaves {left:.2g}", words, left * before / size) if left < EXPLAINS else None


def _candidates(scene: Scene, tracks: ParticleTrajectories, sigma: np.ndarray, law: np.ndarray,
                step: float) -> Iterator[tuple[np.ndarray, str]]:
    """Yields explanations of the stress ``sigma`` (T, P, D, D) in Pa: what each leaves of it, and words."""
    if len(tracks.time) >= 3:
        late = fit_time_lag(tracks.time, sigma, law)
        when = Message("earlier" if late > 0 else "later")
        inside, moved = interpolate_before(tracks.time, law, late)
        whole = time_series_fitting.rms(sigma - law) / max(time_series_fitting.rms((sigma - law)[inside]), 1e-300)
        yield ((sigma[inside] - moved) * whole,
               Message("it fits the F of {late:.3g} s {when} better (a step is {step:.3g} s), so stress and F belong "
                       "to different moments", abs(late), when, step))
    if tracks.material_position.shape[1] > 1:
        transposed = _stress_of_law(scene, tracks, np.swapaxes(tracks.own["F"], -1, -2))
        yield sigma - transposed, Message("it fits the transpose of F")
    if (np.linalg.det(tracks.own["F"]) != 0).all():
        for words, other in MEASURES.items():
            yield sigma - other(tracks.own["F"], law), Message("it fits as {words}", Message(words))
    factor = float(np.sum(sigma * law) / np.sum(law * law))
    yield sigma - factor * law, Message("it fits E = {factor:.4g} Pa, not {modulus:.4g} Pa", factor * scene.modulus,
                                        scene.modulus)
    if "law" in scene.__dataclass_fields__:
        for name in scene.choices("law"):
            stress = _stress_of_law(replace(scene, law=name), tracks)  # type: ignore[call-arg]
            yield sigma - stress, Message("it fits the law {name}", name)
    if hasattr(scene, "poisson_ratio"):
        yield from _fit_moduli(scene, tracks, sigma)


def _fit_moduli(scene: Scene, tracks: ParticleTrajectories, sigma: np.ndarray) -> Iterator[tuple[np.ndarray, str]]:
    """Yields residual (T, P, D, D) in Pa and words for fits of E to the stress at each Poisson's ratio."""
    for ratio in RATIOS:
        try:
            law = _stress_of_law(replace(scene, poisson_ratio=float(ratio)), tracks)  # type: ignore[call-arg]
        except SceneError:
            continue
        factor = float(np.sum(sigma * law) / np.sum(law * law))
        yield (sigma - factor * law,
               Message("it fits Poisson's ratio {ratio:.2g} with E = {factor:.4g} Pa, not {scene.poisson_ratio:.2g} "
                       "with {scene.modulus:.4g} Pa", ratio=ratio, factor=factor * scene.modulus, scene=scene))


def fit_time_lag(times: np.ndarray, sigma: np.ndarray, law: np.ndarray) -> float:
    """Returns the lag in s of the stress (T, P, D, D) behind ``law``'s at ``times`` (T,), by least squares."""
    slope = time_derivative(times, law)
    late = -float(np.sum((sigma - law) * slope)) / max(float(np.sum(slope * slope)), 1e-300)
    steps = float(np.median(np.diff(times)))
    tried = {late, steps, -steps}
    for _ in range(3):  # of Gauss and Newton
        inside, moved = interpolate_before(times, law, late)
        if inside.sum() < 2:
            break
        late -= float(np.sum((sigma[inside] - moved) * slope[inside])) / max(float(np.sum(slope[inside] ** 2)), 1e-300)
        tried.add(late)

    def left(one: float) -> float:
        inside, moved = interpolate_before(times, law, one)
        return time_series_fitting.rms(sigma[inside] - moved) if inside.sum() >= 2 else np.inf

    return min(tried, key=left)


def _stress_of_law(scene: Scene, tracks: ParticleTrajectories, F: np.ndarray | None = None) -> np.ndarray:
    """Returns the Cauchy stress (T, P, D, D) in Pa by the scene's law, of the tracks' F or another."""
    F = tracks.own["F"] if F is None else F
    return PROBLEMS[scene.problem].reference.stress(scene, F.reshape(-1, *F.shape[2:])).reshape(F.shape)


def _conversion_from_cauchy_stress(measure: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]) -> Callable:
    """Returns a function of F and Cauchy stress (..., D, D) for a ``measure`` of J, the inverse of F, and stress."""
    def other(F: np.ndarray, sigma: np.ndarray) -> np.ndarray:
        return measure(np.linalg.det(F)[..., None, None], np.linalg.inv(F), sigma)
    return other


#: Other stresses that a code may have written, from F and the Cauchy stress.
MEASURES: dict[str, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
    "the stress with the other sign": lambda F, sigma: -sigma,
    "the Kirchhoff stress": _conversion_from_cauchy_stress(lambda J, G, sigma: J * sigma),
    "the first Piola-Kirchhoff stress":
        _conversion_from_cauchy_stress(lambda J, G, sigma: J * sigma @ np.swapaxes(G, -1, -2)),
    "the second Piola-Kirchhoff stress":
        _conversion_from_cauchy_stress(lambda J, G, sigma: J * G @ sigma @ np.swapaxes(G, -1, -2))}
