"""The page: what one sees live."""
