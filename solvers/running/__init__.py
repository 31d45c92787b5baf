"""Runs a scene from start to end: the result, and its timing."""
