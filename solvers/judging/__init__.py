"""A referee for any code: particles in a file, read, held against the truth or a companion, and beside our own runs."""
