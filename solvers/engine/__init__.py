"""Simulation processes for the page.

A Taichi launch holds Python's global lock for its whole duration, so the process that serves the page never
runs a kernel. :class:`~solvers.engine.pool.EnginePool` lives with the page; each engine process it starts runs
:func:`~solvers.engine.worker.main`. Between them go wishes one way and frames the other
(:mod:`~solvers.engine.messages`); particle data cross in shared memory (:mod:`~solvers.engine.frames`).
"""
