"""One step in slow motion, as data."""
