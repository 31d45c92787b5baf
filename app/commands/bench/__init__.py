"""Benchmarks of this machine, and load tests with a simulated class."""
