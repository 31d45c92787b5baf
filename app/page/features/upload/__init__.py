"""A visitor's own particle file: judged in the background, and shown as a run."""
