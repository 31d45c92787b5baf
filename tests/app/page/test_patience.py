"""The word that says which control waits for a compiler."""

from __future__ import annotations

from types import SimpleNamespace

from app.page.panels.bound import MARK, Patience


def widget(label):
    return SimpleNamespace(label=label, _impl=SimpleNamespace(removed=False))


def test_the_mark_stands_beside_the_last_control_and_goes():
    method, cells = widget("Method"), widget("Cells, h = 1/40")
    patience = Patience()
    patience.show(True)  # what compiles is the first scene
    patience.changed(method)
    patience.show(True)
    patience.show(True)
    assert method.label == "Method" + MARK
    patience.changed(cells)
    patience.show(True)
    assert (method.label, cells.label) == ("Method", "Cells, h = 1/40" + MARK)
    patience.show(False)
    assert (method.label, cells.label) == ("Method", "Cells, h = 1/40")


def test_a_label_that_changes_meanwhile_stays_changed():
    """The label of the cells says how many there are."""
    cells, patience = widget("Cells, h = 1/40"), Patience()
    patience.changed(cells)
    patience.show(True)
    cells.label = "Cells, h = 1/44"
    patience.show(True)
    assert cells.label == "Cells, h = 1/44" + MARK
    patience.show(False)
    assert cells.label == "Cells, h = 1/44"


def test_a_removed_control_is_left_alone():
    """Those of a problem go with it."""
    method, patience = widget("Method"), Patience()
    patience.changed(method)
    patience.show(True)
    method._impl.removed = True
    patience.show(False)
    assert method.label == "Method" + MARK
