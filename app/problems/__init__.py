"""How each problem is shown: one folder a problem, and the registry of them (:mod:`app.problems.views`)."""
