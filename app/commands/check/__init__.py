"""Checks of particles of any run for contradictions."""
