"""The companion of a body with rotational symmetry: its mesh, and its solution without a run, all in numpy."""

import functools
from typing import Any

import numpy as np

from solvers.estimators.spectral_elements import Elements, highest_frequency
from solvers.estimators.standalone_companion import ElasticBody
from solvers.motion.laws.material_law import determinant
from solvers.problems.planar.body_force import tabulate_body_force
from solvers.problems.planar.particle_layout import points_on_x_axis

INSTANTS = 16  # of a period, at which the stiffest deformation is searched


def sector_masses(elements: Elements) -> np.ndarray:
    """Returns quadrature weight times radius (N,) in m^2 of nodes along a radius: their areas in a sector of 1 rad."""
    return elements.assembled_weights * elements.node_coordinates


@functools.cache
def unit_frequency(elements: Elements) -> float:
    """Returns the highest frequency in 1/s of u_tt = u'' + u'/R - u/R^2 on a radius: waves of 1 m/s at rest."""
    R, node, weights = elements.node_coordinates, elements.node_of_point, elements.weights
    inverse_mass = 1 / sector_masses(elements)

    def accelerations(u: np.ndarray) -> np.ndarray:
        stretch = u[node] @ elements.derivative.T
        pull = (stretch * weights * R[node]) @ elements.derivative + weights * u[node] / R[node]
        return inverse_mass * np.bincount(node.ravel(), pull.ravel())

    return highest_frequency(accelerations, inverse_mass)


class CircularCompanionBody(ElasticBody):
    """Elastic body with a motion that is the same all around, given by two functions of the radius on ``count``
    elements of ``order`` (``solvers.problems.planar.estimators.circular_companion`` has the equations). The unknowns
    (N, 2) are the displacements in m of points on the x axis, along it and across it."""

    def __init__(self, scene: Any, count: int, order: int):
        self.elements, self._material = Elements(scene.INNER, scene.OUTER, count, order), scene.material
        self._R = self.elements.node_coordinates
        self.points = points_on_x_axis(self._R)
        self.inverse_mass = np.repeat(1 / (scene.density * sector_masses(self.elements))[:, None], 2, axis=1)
        self.velocity = scene.EXACT.velocity(scene, self.points, 0.0)
        self.force = tabulate_body_force(scene, self.points)
        self.frequency_at_rest = scene.wave_speed * unit_frequency(self.elements)
        times = np.arange(INSTANTS) / INSTANTS * scene.period
        F = np.concatenate([scene.EXACT.deformation_gradient(scene, self.points, t) for t in times])
        self.frequency = self.frequency_at_rest * self.stiffening(F.reshape(-1, 4).T)

    def stiffening(self, F: Any) -> float:
        """Returns the largest factor, at least 1, by which F, four components in (e_R, e_Theta), raises frequencies of
        waves along the radius; |F^-T e_R| = |F e_Theta|/J."""
        pressed = (F[1] * F[1] + F[3] * F[3]) / determinant(F) ** 2
        return self._material.max_frequency_factor(F, F[0] * F[0] + F[2] * F[2], pressed)

    def deformation_gradient(self, z: np.ndarray) -> tuple[np.ndarray, ...]:
        """Returns F as rr, rt, tr, tt, r along e_R and t along e_Theta, at the elements' points (count, p+1), for
        nodes at complex places z (N,) in m: columns z', i z/R."""
        node = self.elements.node_of_point
        slope, hoop = z[node] @ self.elements.derivative.T, z[node] / self._R[node]
        return slope.real, -hoop.imag, slope.imag, hoop.real

    def accelerations(self, u: np.ndarray, t: float) -> np.ndarray:
        with np.errstate(all="ignore"):  # for a lost motion, which the caller detects
            internal = self.internal_acceleration(self._R + u[:, 0] + 1j * u[:, 1])
        return self.force(t) + np.stack([internal.real, internal.imag], axis=1)

    def internal_acceleration(self, z: np.ndarray) -> np.ndarray:
        """Returns the nodes' acceleration (N,) by stress in m/s^2, complex like their places z in m: along e_R at rest,
        and as imaginary part along e_Theta."""
        node, w = self.elements.node_of_point, self.elements.weights
        xx, xy, yx, yy = self._material.first_piola_stress(self.deformation_gradient(z))
        pull = (w * self._R[node] * (xx + 1j * yx)) @ self.elements.derivative + w * (yy - 1j * xy)
        total = np.zeros(len(z), complex)
        np.add.at(total, node, pull)
        return -self.inverse_mass[:, 0] * total

    def values_and_gradients(self, u: np.ndarray, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        R = np.linalg.norm(X, axis=1)
        e = X / R[:, None]
        element, values, slopes = self.elements.evaluate_basis(R)
        local = u[self.elements.node_of_point[element]]
        there, slope = (np.einsum("pi,pic->pc", basis, local) for basis in (values, slopes))
        outward = vectors_from_components(e, slope)
        around = vectors_from_components(e, rotate_right(-there) / R[:, None])
        return vectors_from_components(e, there), \
            outward[:, :, None] * e[:, None] + around[:, :, None] * rotate_right(-e)[:, None]


def rotate_right(vectors: np.ndarray) -> np.ndarray:
    """Returns vectors (..., 2) turned right by 90 degrees."""
    return np.stack([vectors[..., 1], -vectors[..., 0]], axis=-1)


def vectors_from_components(e: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """Returns vectors (P, 2) from ``parts`` (P, 2) along unit vectors e (P, 2), and e turned left by 90 degrees."""
    return parts[:, :1] * e - parts[:, 1:] * rotate_right(e)
