"""What the vortex adds to the method in the plane: arrays, material and force, exact solution."""
