"""Public MPM codes that we did not write, on problems of the lab, and judged: ``python -m tests.strangers``."""
