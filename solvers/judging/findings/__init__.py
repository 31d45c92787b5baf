"""What a run's particles show to be wrong, with the exact solution or without."""
