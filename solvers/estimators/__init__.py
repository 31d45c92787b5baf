"""One file an error estimator and problem: what it allocates, what it does in a step, what it reports per particle."""
