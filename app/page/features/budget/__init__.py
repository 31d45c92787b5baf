"""The error budget of the run on the stage."""
