"""Who made this error? The budget of the run on the stage."""
