"""The picture of a result in a notebook, whose own pictures keep their looks."""

import matplotlib
from matplotlib.figure import Figure

from solvers.running.result import Result


def result_picture(result: Result) -> Figure:
    """The figure that ``mpm-lab run --plot`` writes."""
    with matplotlib.rc_context():  # what is imported here sets them for the whole process, which is the user's
        from app.pictures.run import run_figure
        from app.renderers.look import SETTINGS
        matplotlib.rcParams.update(SETTINGS)
        return run_figure(result)
