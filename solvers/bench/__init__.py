"""Benchmarks: speed of the solvers, cost of each effect, and start-up time.

``benchmarks`` has the rates and the prices, and compares each problem's step with one without optional code, where
there is one (``solvers.problems.descriptor.Problem.baseline``); ``gpu`` measures a GPU if there is one; ``start_up``
the start-up and compile times, both in fresh processes (``solvers.workers.worker_process``); ``cpp_reference`` our
rates over those of hand-written C++ (``cpp/``). ``bench`` combines all of them.
"""
