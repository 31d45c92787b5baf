"""The pictures of the methods are of the weights that the solvers have."""

import numpy as np
import pytest

from app.names_and_units import METHODS
from app.page.panels.simulation_parameter_widgets import HALF_WIDTH, REACH, method_pictures, shape_function_curve


@pytest.mark.parametrize("method", METHODS)
def test_weights_are_even_and_add_up_to_one(method):
    """Over the nodes they do, and so their integral over the places is a cell's width."""
    at, weight = shape_function_curve(method)
    assert (at[0], at[-1]) == (-REACH, REACH)
    assert np.allclose(weight, weight[::-1]) and weight.min() >= 0
    assert weight.sum() * (at[1] - at[0]) == pytest.approx(1, abs=1e-3)


def test_what_tells_the_methods_apart():
    """A hat has a peak, an interval rounds it off, a wide one more; CPDI's is flat between its corners."""
    top = {method: shape_function_curve(method)[1].max() for method in METHODS}
    assert top["ugimp"] == pytest.approx(1 - HALF_WIDTH / 2)
    assert top["mpm"] == 1 > top["ugimp"] > top["cpgimp"] > top["bspline"] == 0.75
    middle = shape_function_curve("cpdi")[1][35:46]
    assert np.ptp(middle) < 1e-12


def test_pictures_are_for_pointers_only():
    """Who hears the page has the dropdown: a second control would say the same again."""
    html = method_pictures(("mpm", "ugimp", "a stranger's <method>"), "ugimp")
    assert html.startswith("<div class='lab-methods' aria-hidden='true'>") and "<button" not in html
    assert html.count("lab-chosen") == 1 and "<polyline" in html and "<method>" not in html
