"""View of the bar: stage, slow motion, pictures, regions."""
