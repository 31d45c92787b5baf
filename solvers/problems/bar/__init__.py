"""The vibrating bar: one dimension, periodic, unit length (paper, section 5)."""
