"""In a notebook: a run that plays below its cell (:func:`show`), and the table of a result.

    from mpm_lab import BarScene, show

    show(BarScene(method="mpm", amplitude=0.0034, periods=0.25), error_of="sigma")
"""

from app.notebook.player import Player, show

__all__ = ["Player", "show"]
