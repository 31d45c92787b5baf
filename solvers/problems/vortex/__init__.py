"""The generalized vortex: a full ring whose circles turn against each other, so that it shears and rotates."""
