"""Execution plans of steps: one kernel for many on one thread, parallel slabs, or on a GPU all particles at once."""
