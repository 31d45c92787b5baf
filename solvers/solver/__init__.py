"""What a solver is to everybody else, whatever the problem: its state, samples, verdict and result."""
