"""A problem for other codes, and their particles judged."""
