"""A body from a file, whose exact solution nobody knows: run in the background, and shown with its estimate."""
