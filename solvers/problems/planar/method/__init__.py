"""The method in the plane, for kernels: arrays, mappings, the phases of a step, remedies, and what is measured."""
