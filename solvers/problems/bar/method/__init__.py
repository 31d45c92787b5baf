"""Kernels of the method on the bar: state, phases of a step, remedies, and diagnostics."""
