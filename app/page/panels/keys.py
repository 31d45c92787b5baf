"""What keys ask for that no button on the page stands for (``js/keys.js``)."""

from collections.abc import Callable, Mapping
from typing import Any

from app.page.panels.browser_store import BrowserStore


def follow_keys(store: BrowserStore, acts: Mapping[str, Callable[[], None]]) -> None:
    """Do one of the ``acts`` when the browser says its name; what else it says means nothing."""
    def act(said: Any) -> None:
        if isinstance(said, str) and said in acts:
            acts[said]()

    store.heard["act"] = act
