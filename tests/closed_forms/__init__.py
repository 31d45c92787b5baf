"""The exact solutions of ring and vortex as they are printed, written out by hand: what is derived is held against."""
