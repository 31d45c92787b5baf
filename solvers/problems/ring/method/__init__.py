"""What the ring adds to the method in the plane: arrays, material and force, symmetry planes, exact solution."""
