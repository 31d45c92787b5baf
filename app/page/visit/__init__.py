"""One visitor's data: requests, results and history. Independent of how it is shown."""
