"""Features of the page beside showing a run: a file or folder each, with the feature's panel."""
