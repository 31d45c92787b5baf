"""Kernels of the method in the plane: state, mappings, phases of a step, remedies, and diagnostics."""
