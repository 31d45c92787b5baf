"""Exact solutions obey their equations, whatever the numbers: of all problems, as another code would read them.

Derivatives by central differences: over 1e-5 m and 1e-4 of a period they miss at most 1e-5 of the largest term.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solvers.motion.laws.elastic_material import LAWS
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from tests.support.random_scenes import LARGEST, logarithmic, typed_lines, typed_motions

STEP, BRIEF = 1e-5, 1e-4  # m and periods
NEAR = 1e-5


@st.composite
def moments(draw: st.DrawFn, problem: str) -> tuple[Scene, np.ndarray, float]:
    """A scene, some of its particles' material points (P, D), which lie inside the body, and a time."""
    line = st.fixed_dictionaries({"body_force": st.sampled_from(("material", "none"))}) \
        | st.fixed_dictionaries({"displacement": typed_lines()})
    more = {"bar": draw(line.map(lambda inputs: {name: st.just(value) for name, value in inputs.items()})),
            "vortex": {"poisson_ratio": st.floats(0.0, 0.45), "frequency": logarithmic(0.1, 10.0)},
            "square": {"displacement": st.just("") | typed_motions(), "law": st.sampled_from([*LAWS])}}.get(problem, {})
    scene = PROBLEMS[problem].scene(cells=24, estimators=(), amplitude=draw(logarithmic(1e-3, 0.9)) * LARGEST[problem],
                                    modulus=draw(logarithmic(1e-3, 1e9)), density=draw(logarithmic(1e-2, 1e4)),
                                    **{name: draw(values) for name, values in more.items()})
    X = PROBLEMS[problem].reference.start(scene).material_position
    which = draw(st.lists(st.integers(0, len(X) - 1), min_size=1, max_size=8, unique=True))
    return scene, X[which], draw(st.floats(0.0, 2.0)) * scene.period


def gradient(function, X: np.ndarray) -> np.ndarray:
    """d f/d X_j of a function of points (P, D), in the last place."""
    shifts = STEP * np.eye(X.shape[1])
    return np.stack([(function(X + d) - function(X - d)) / (2 * STEP) for d in shifts], axis=-1)


def near(one: np.ndarray, other: np.ndarray, *terms: np.ndarray) -> bool:
    """Equal but for ``NEAR`` of the largest term that they are made of."""
    return np.abs(one - other).max() <= NEAR * max(np.abs(term).max() for term in (one, other, *terms))


@pytest.mark.parametrize("problem", PROBLEMS)
def test_kinematics(problem):
    """F = I + grad u, v = du/dt and a = dv/dt; sigma is that of the law and F; u returns."""
    reference = PROBLEMS[problem].reference

    @given(moments(problem))
    def hold(moment):
        scene, X, t = moment
        F = np.eye(X.shape[1]) + gradient(lambda Y: reference.displacement(scene, Y, t), X)
        assert near(F, reference.deformation_gradient(scene, X, t))
        brief = BRIEF * scene.period
        before, after = (reference.displacement(scene, X, t + side * brief) for side in (-1, 1))
        largest = scene.size_of("x") / scene.period  # v itself may be next to nothing at its turning point
        assert near((after - before) / (2 * brief), reference.velocity(scene, X, t), np.array([largest]))
        before, after = (reference.velocity(scene, X, t + side * brief) for side in (-1, 1))
        a = reference.EXACT.acceleration(scene, X, t)
        assert near((after - before) / (2 * brief), a, np.array([largest / scene.period]))
        sigma = reference.stress(scene, reference.deformation_gradient(scene, X, t)).reshape(len(X), -1)
        own = sigma[:, [0, 1, 3]] if X.shape[1] == 2 else sigma
        rounding = 1e-13 * scene.density * scene.wave_speed**2
        np.testing.assert_allclose(reference.EXACT.stress(scene, X, t).reshape(own.shape), own, rtol=0, atol=rounding)
        now, later = (reference.displacement(scene, X, one) for one in (t, t + scene.period))
        assert near(now, later, np.array([scene.size_of("x")]))

    hold()


@pytest.mark.parametrize("problem", PROBLEMS)
def test_momentum_balance(problem):
    """rho d2u/dt2 = Div P + rho b, with P = J sigma F^-T and sigma by the law of the material."""
    reference = PROBLEMS[problem].reference

    @given(moments(problem))
    def hold(moment):
        scene, X, t = moment

        def piola(Y):
            F = reference.deformation_gradient(scene, Y, t)
            transposed = np.linalg.inv(F).swapaxes(1, 2)
            return np.linalg.det(F)[:, None, None] * reference.stress(scene, F) @ transposed

        brief = BRIEF * scene.period
        v = [reference.velocity(scene, X, t + side * brief) for side in (-1, 1)]
        inertia = scene.density * (v[1] - v[0]) / (2 * brief)
        gradients = gradient(piola, X)
        force = scene.density * reference.body_force(scene, X, t)
        divergence = np.einsum("pijj->pi", gradients)
        largest = scene.density * scene.size_of("x") / scene.period**2
        rounding = 1e-15 * scene.density * scene.wave_speed**2 / STEP / NEAR  # of P, whose differences are taken
        assert near(inertia, divergence + force, divergence, force, gradients, np.array([largest + rounding]))

    hold()
