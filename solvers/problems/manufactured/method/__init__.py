"""What kernels know of manufactured problems."""
