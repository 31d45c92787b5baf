"""Benchmarks: speed of the solvers, cost of each diagnostic, start-up time, gain by a GPU, rates over those of C++."""
