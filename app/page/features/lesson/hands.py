"""What a lesson does with the page's controls, in its reader's place."""

from collections.abc import Callable
from typing import Protocol

import viser

from app.state import State
from solvers.scene.scene import Scene


class Hands(Protocol):
    """The controls, as :class:`~app.page.controls.Controls` has them."""

    @property
    def state(self) -> State:
        """What the visitor sees."""

    def show(self, state: State) -> None:
        """Put all of a state on the stage."""

    def offer(self, controls: tuple[str, ...], place: viser.GuiFolderHandle | None = None) -> None:
        """Show only these controls, in another place than their own tab; all, and there, where nothing is given."""

    def change(self, field: str, said: str, meant: Callable[[Scene], object]) -> None:
        """Set a field of the scene to what the lesson has ``said``."""

    def look(self, quantity: str = "", estimator: str = "") -> None:
        """Show the error of a quantity, or as an estimator sees it."""

    def press(self, name: str) -> None:
        """What the button of this name in the deck does."""
