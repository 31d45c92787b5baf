"""One time step in slow motion."""
