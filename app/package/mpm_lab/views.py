"""What draws a result, as pyproject names it to ``solvers.running.result``, whatever else is called ``app``."""

from typing import Any

from mpm_lab import take


def plot(result: Any) -> Any:
    """The picture of a result, a matplotlib figure."""
    take("app")
    from app.notebook.result import result_picture

    return result_picture(result)


def table(result: Any) -> str:
    """The table of a result, HTML."""
    take("app")
    from app.notebook.result import result_table

    return result_table(result)
