"""The ring's estimators: one file each."""
