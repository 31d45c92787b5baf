"""Commands for many runs: sweeps, searches, maps and the paper's tables."""
