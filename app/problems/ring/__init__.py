"""How the ring is shown: on the stage, in pictures, in regions."""
