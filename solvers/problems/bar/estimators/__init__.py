"""The bar's estimators: one file each."""
