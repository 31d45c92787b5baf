"""The vortex's estimators: one file each."""
