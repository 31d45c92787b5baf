"""One visitor's data: what was wished, what came back, what is remembered. Knows nothing of how it is shown."""
