"""Interaction with the stage: its camera, tracing a particle, reading errors in a region."""
