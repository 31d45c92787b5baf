"""What is seen of a run, as data and words: for the page, for exported files and for pictures alike."""
