"""How the bar is shown: on the stage, in pictures, in regions."""
