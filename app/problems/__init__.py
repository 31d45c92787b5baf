"""Views of the problems: stages, pictures and texts, and their registry (:mod:`app.problems.views`)."""
