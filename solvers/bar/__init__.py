"""The vibrating bar: one dimension, periodic, unit length (NUMERICS of the paper's section 5)."""
