"""How the vortex is shown: on the stage, in pictures, in regions."""
