"""The method in the plane: what every problem of two dimensions shares, whatever its shape, material and symmetry."""
