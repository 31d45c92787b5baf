"""The About tab: what the page shows, in the words of someone who sees it for the first time."""

from __future__ import annotations

import viser

from app.colours import ESTIMATE, TRUTH
from app.problems.views import VIEWS
from solvers.estimators.registry import ESTIMATORS

ABOUT = f"""<div class='lab-about'>
<h3>What moves here</h3>
{"".join(view.about for view in VIEWS.values())}
<h3>Two lanes, one scale</h3>
<p>Every particle is drawn twice. The upper lane (of the ring, the left half) is coloured by the error that an
<span class='lab-key' style='color:{ESTIMATE}'>estimator</span> computes while the simulation runs, without knowing
the solution; the lower lane (the right half) by the <span class='lab-key' style='color:{TRUTH}'>true</span> error
against the exact solution. If the lanes look alike, the estimate has the right size in the right place. "Compare:
estimate − truth" colours the first lane by what the estimate misses, direction and all, on the same scale: dark is
good.</p>
<h3>The error index</h3>
<p>The sum over time of the estimated norms over that of the true ones: 1 is perfect, 2 means twice too large,
0.5 half. An index near 1 can still hide an estimate in the wrong place or of the wrong sign. The <b>distance</b>
cannot: it is the size of estimate minus truth over the size of the truth, particle by particle. 0 is perfect; 1 is no
better than saying nothing.</p>
<h3>The worst region</h3>
<p>The material is divided: {", ".join(view.division for view in VIEWS.values())}. The
region with the largest root-mean-square error is named, once by the estimate and once by the truth.</p>
<h3>How the estimators work</h3>
<p>None of them uses the exact solution. Where one is known not to hold, the page says so instead of a number.</p>
</div>"""

TRY_THIS = """<div class='lab-about'>
<h3>Try this</h3>
<p>Method "MPM (hat functions)" with A = 0.03: the error jumps whenever particles cross cell boundaries. Switch to
uGIMP or B-spline with the same crossings. Then put the body force at the nodes: the error stays when h is halved.
It is easy to blame grid crossing for it; the crossings were the same before.</p>
</div>"""


def add_about(gui: viser.GuiApi) -> None:
    """Fill the tab: the page, each estimator behind its name, and something to try."""
    gui.add_html(ABOUT)
    for estimator in ESTIMATORS.values():
        with gui.add_folder(f"The estimator {estimator.title}", expand_by_default=False):
            gui.add_html(f"<div class='lab-about lab-explanation'>{estimator.explanation}</div>")
    gui.add_html(TRY_THIS)
