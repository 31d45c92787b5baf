"""Export of a lesson or scene as one file that plays offline: recordings, a player, and the lesson's texts."""
