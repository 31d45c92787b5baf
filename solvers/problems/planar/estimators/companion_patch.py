"""A patch of a body, meshed by spectral elements in two coordinates xi and eta, for the companion."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from solvers.estimators.spectral_elements import Elements, highest_frequency
from solvers.estimators.standalone_companion import ElasticBody
from solvers.problems.planar.body_force import tabulate_body_force

_frequencies: dict[tuple, float] = {}  # of bodies at rest by mesh, moduli and mass: sliders ask for the same again
INSTANTS = 8  # of a period, at which the stiffest deformation is searched


class CoordinateMap(NamedTuple):
    """Map X(xi, eta) of a patch: ``place(xi, eta)`` returns points (N, 2) in m for coordinates (N,) each, ``tangents``
    dX/dxi and dX/deta (N, 2) each, ``coordinates(X)`` xi and eta (P,) of material points (P, 2) in m."""

    place: Callable[[np.ndarray, np.ndarray], np.ndarray]
    tangents: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
    coordinates: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


#: A rectangle along the axes.
CARTESIAN = CoordinateMap(lambda xi, eta: np.stack([xi, eta], axis=1),
                          lambda xi, eta: (np.tile([1.0, 0.0], (len(xi), 1)), np.tile([0.0, 1.0], (len(xi), 1))),
                          lambda X: (X[:, 0], X[:, 1]))


def contravariant_vectors(tangents: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """Returns j grad xi and j grad eta (N, 4) from ``tangents`` dX/dxi, dX/deta (N, 2), j = det dX/d(xi, eta)."""
    (a, b), (c, d) = (one.T for one in tangents)
    return np.stack([d, -c, -b, a], axis=1)


class CompanionPatch(ElasticBody):
    """Elastic body of a scene's companion on one patch, in numpy. ``lines`` are the elements along xi and along eta, of
    one order, ``patch_map`` maps these coordinates to material points; ``held`` returns which components (N, 2) of
    nodes at material points (N, 2) in m a symmetry plane fixes."""

    def __init__(self, scene: Any, lines: tuple[Elements, Elements], patch_map: CoordinateMap,
                 held: Callable[[np.ndarray], np.ndarray]):
        first, second = self.lines = lines
        self.map, self._material = patch_map, scene.material
        self._shape = len(first.node_coordinates), len(second.node_coordinates)
        xi, eta = (line.ravel() for line in np.meshgrid(first.node_coordinates, second.node_coordinates, indexing="ij"))
        self.places = patch_map.place(xi, eta)
        self.geometry = contravariant_vectors(patch_map.tangents(xi, eta))
        self._area = self.geometry[:, 0] * self.geometry[:, 3] - self.geometry[:, 1] * self.geometry[:, 2]
        mass = scene.density * np.outer(first.assembled_weights, second.assembled_weights).ravel() * self._area
        self.inverse_mass = ~held(self.places) / mass[:, None]
        self._free = (self.inverse_mass > 0).astype(float)
        self.velocity = scene.EXACT.velocity(scene, self.places, 0.0) * self._free
        self.force = tabulate_body_force(scene, self.places)
        self._node = np.add(*np.broadcast_arrays(first.node_of_point[:, None, :, None] * self._shape[1],
                                                 second.node_of_point[None, :, None, :]))
        self._weight = np.outer(first.weights, second.weights)[..., None]
        key = (*lines, *scene.lame_moduli, self.inverse_mass.tobytes())
        if key not in _frequencies:
            _frequencies[key] = highest_frequency(lambda u: self.inverse_mass
                                                  * self._internal_forces(u, self._hookean_stress), self.inverse_mass)
        self.frequency_at_rest = _frequencies[key]
        times = np.arange(INSTANTS) / INSTANTS * scene.period
        F = np.concatenate([scene.EXACT.deformation_gradient(scene, self.places, t) for t in times])
        axes = np.linalg.svd(F, compute_uv=False).T ** 2
        self.frequency = self.frequency_at_rest * max(
            self._material.max_frequency_factor(F.reshape(-1, 4).T, one, 1 / one) for one in axes)

    def _hookean_stress(self, xx: Any, xy: Any, yx: Any, yy: Any) -> tuple[Any, Any, Any, Any]:
        """Returns the stress as xx, xy, yx, yy in Pa by Hooke's law, for arrays of Grad u in the same order."""
        _, bulk, mu = self._material
        shear = mu * (xy + yx)
        return bulk * (xx + yy) + 2 * mu * xx, shear, shear, bulk * (xx + yy) + 2 * mu * yy

    def _internal_forces(self, u: np.ndarray, law: Callable[..., Any]) -> np.ndarray:
        """Returns the internal forces (N, 2), in N per metre of thickness, that resist displacements u (N, 2) in m;
        ``law`` returns the stress in Pa from Grad u, both as xx, xy, yx, yy."""
        (first, second), local = self.lines, u[self._node]  # (a, b, i, k, 2)
        by_xi = np.einsum("ik,abkjc->abijc", first.derivative, local, optimize=True)
        by_eta = np.einsum("jk,abikc->abijc", second.derivative, local, optimize=True)
        g, j = self.geometry[self._node], self._area[self._node][..., None]
        by_x = (by_xi * g[..., 0:1] + by_eta * g[..., 2:3]) / j
        by_y = (by_xi * g[..., 1:2] + by_eta * g[..., 3:4]) / j
        xx, xy, yx, yy = law(by_x[..., 0], by_y[..., 0], by_x[..., 1], by_y[..., 1])
        P_xi, P_eta = (self._weight * np.stack([xx * a + xy * b, yx * a + yy * b], axis=-1)
                       for a, b in ((g[..., 0], g[..., 1]), (g[..., 2], g[..., 3])))
        pull = np.einsum("ki,abkjc->abijc", first.derivative, P_xi, optimize=True) \
            + np.einsum("kj,abikc->abijc", second.derivative, P_eta, optimize=True)
        total = np.zeros_like(u)
        np.add.at(total, self._node, pull)
        return total

    def accelerations(self, u: np.ndarray, t: float) -> np.ndarray:
        return self._free * self.force(t) - self.inverse_mass * self._internal_forces(
            u, lambda xx, xy, yx, yy: self._material.first_piola_stress((1 + xx, xy, yx, 1 + yy)))

    def values_and_gradients(self, u: np.ndarray, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        xi, eta = self.map.coordinates(X)
        (first, second), slopes = self.lines, self.coordinate_gradients(X)
        a, along_xi, slope_xi = first.evaluate_basis(xi)
        b, along_eta, slope_eta = second.evaluate_basis(eta)
        local = u[first.node_of_point[a][:, :, None] * self._shape[1] + second.node_of_point[b][:, None]]
        values, by_xi, by_eta = (np.einsum("pi,pj,pijc->pc", one, two, local) for one, two in (
            (along_xi, along_eta), (slope_xi, along_eta), (along_xi, slope_eta)))
        return values, by_xi[:, :, None] * slopes[:, None, :2] + by_eta[:, :, None] * slopes[:, None, 2:]

    def coordinate_gradients(self, X: np.ndarray) -> np.ndarray:
        """Returns grad xi and grad eta (P, 4) at material points X (P, 2) in m."""
        g = contravariant_vectors(self.map.tangents(*self.map.coordinates(X)))
        return g / (g[:, 0] * g[:, 3] - g[:, 1] * g[:, 2])[:, None]
