"""A class that takes a lesson together: its board, its answers, and the data that its pages share."""
