"""A lesson or a scene as one file that plays from disk: recordings, a player and what a lesson says."""
