"""What the terminal at the other end can show, as far as its environment says."""

from collections.abc import Mapping


def coloured(environment: Mapping[str, str], is_terminal: bool) -> bool:
    """Whether colours are wanted: on a terminal that has them, or with FORCE_COLOR; never with NO_COLOR
    (https://no-color.org)."""
    if environment.get("NO_COLOR") or is_dumb(environment):
        return False
    return is_terminal or bool(environment.get("FORCE_COLOR"))


def is_dumb(environment: Mapping[str, str]) -> bool:
    """Whether the terminal can neither colour nor take back what it has shown."""
    return environment.get("TERM") in (None, "", "dumb")
