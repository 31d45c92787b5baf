"""Simulation processes for the page.

A Taichi launch holds Python's global lock for its whole duration, so the process that serves the page never runs a
kernel. :class:`~solvers.engine.engine_pool.EnginePool` belongs to the page; each engine process that it starts runs
:func:`~solvers.engine.engine_server.serve_engine`. Requests go one way and frames the other
(:mod:`~solvers.engine.engine_messages`); particle data are passed in shared memory
(:mod:`~solvers.engine.shared_frames`). Landscapes are computed beside an engine, by
:mod:`~solvers.engine.surveyor`.
"""
