"""The pictures of the methods are of the weights that the solvers have."""

import numpy as np
import pytest

from app.names_and_units import METHODS
from app.page.panels.method_tiles import HALF_WIDTH, REACH, method_tiles, shape_function_curve


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


def test_methods_are_radio_buttons_with_one_stop_of_the_tab_key():
    """Each is called by its whole name, of which the tile shows a part."""
    html = method_tiles({"mpm": "MPM (hat functions)", "ugimp": "uGIMP", "a <method>": "a <method>"}, "ugimp")
    assert html.count("role='radio'") == 3 and html.count("aria-checked='true' tabindex='0'") == 1
    assert "aria-label='MPM (hat functions)'" in html and "<polyline" in html and "<method>" not in html
