"""Interface of a solver, independent of the problem: its state, samples, verdict and result."""
