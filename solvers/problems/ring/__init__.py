"""The expanding ring: two dimensions, plane strain, a quarter of it between two symmetry planes (paper, section 6)."""
