"""A lesson beside the stage."""
