"""Particles of any run, looked through for contradictions."""
