"""A visitor's own file of particles: judged in the background, and shown as a run of its own."""
