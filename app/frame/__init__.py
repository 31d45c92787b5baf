"""The drawing of a frame as data: marks, scale, halves and texts. Problems produce it, renderers draw it."""
