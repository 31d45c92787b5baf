"""Material laws of the plane, each a file, written once for arrays, jets and kernels."""
