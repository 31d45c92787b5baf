"""The About tab: what the page shows, in the words of someone who sees it for the first time."""

from __future__ import annotations

from app.colours import ESTIMATE, TRUTH

ABOUT = f"""<div class='lab-about'>
<h3>What moves here</h3>
<p>A bar of unit length, periodic, vibrates as
<math display='block'><mi>u</mi><mo>=</mo><mi>A</mi><mo>sin</mo><mo>(</mo><mn>2</mn><mi>π</mi><mi>X</mi><mo>)</mo>
<mo>sin</mo><mo>(</mo><mi>ω</mi><mi>t</mi><mo>)</mo><mo>,</mo><mspace width='0.6em'/><mi>ω</mi><mo>=</mo><mi>π</mi>
<msqrt><mrow><mi>E</mi><mo>/</mo><mi>ρ</mi></mrow></msqrt></math>
because a body force makes exactly that the solution. The Material Point Method knows only the force: it carries
mass, momentum and stress on particles and solves for the acceleration on a grid.</p>
<h3>Two lanes, one scale</h3>
<p>Every particle is drawn twice. The upper lane is coloured by the error that an
<span class='lab-key' style='color:{ESTIMATE}'>estimator</span> computes while the simulation runs, without knowing
the solution; the lower lane by the <span class='lab-key' style='color:{TRUTH}'>true</span> error against the exact
solution. If the lanes look alike, the estimate has the right size in the right place.</p>
<h3>The error index</h3>
<p>The sum over time of the estimated norms over that of the true ones: 1 is perfect, 2 means twice too large,
0.5 half. An index near 1 can still hide an estimate in the wrong place or of the wrong sign. The <b>distance</b>
cannot: it is the size of estimate minus truth over the size of the truth, particle by particle. 0 is perfect; 1 is no
better than saying nothing.</p>
<h3>The estimator "transport"</h3>
<p>Berzins' estimator sends the error that each step makes in turning stress into acceleration through the method's
own equations. It sees the gradient mapping and the stress; it does not see interpolation errors of the velocity or
errors of the time step, so expect a number of the right kind and not of the right size: its stress is often good, its
displacement and velocity are often too small and can even have the wrong sign.</p>
<h3>Try this</h3>
<p>Method "MPM (hat functions)" with A = 0.03: the error jumps whenever particles cross cell boundaries. Switch to
uGIMP or B-spline with the same crossings. Then put the body force at the nodes: the error stays when h is halved.
It is easy to blame grid crossing for it; the crossings were the same before.</p>
</div>"""
