"""Judge for particles of any code: reads files and compares particles with the truth, a companion and our own runs."""
