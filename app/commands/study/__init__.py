"""Many runs: sweeps, searches, maps and the paper's tables."""
