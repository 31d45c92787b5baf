"""The method in the plane: shared code of all two-dimensional problems, whatever their shape, material and symmetry."""
