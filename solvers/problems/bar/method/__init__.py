"""The method on the bar, for kernels: arrays, the phases of a step, remedies, and what is measured."""
