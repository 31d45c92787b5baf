"""Functions that draw a result; pyproject names them for ``solvers.running.result``."""

from typing import Any

from mpm_lab import import_own_package


def plot(result: Any) -> Any:
    """Returns the picture of a run's Result, a matplotlib figure."""
    import_own_package("app")
    from app.notebook.result_display import result_picture
    return result_picture(result)


def table(result: Any) -> str:
    """Returns the table of a run's Result, as HTML."""
    import_own_package("app")
    from app.notebook.result_display import result_table
    return result_table(result)
