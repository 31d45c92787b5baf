"""Motions as data: a displacement is written once as a formula, and all that follows from it is derived."""
