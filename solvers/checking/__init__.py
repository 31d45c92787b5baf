"""Particles of any run, whatever its problem: what within their motion contradicts itself."""
