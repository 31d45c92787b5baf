"""What is seen of a run, as data: marks, scale, halves and words. Problems fill it, renderers draw it."""
