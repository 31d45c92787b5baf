"""Motions as data: a displacement is written once as a formula, and everything else is derived from it."""
