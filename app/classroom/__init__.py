"""A class that takes a lesson together: its board, its answers, and what its pages share."""
