"""Slow motion of one step, as data."""
