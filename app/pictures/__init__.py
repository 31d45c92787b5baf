"""Everything that is drawn to a file."""
