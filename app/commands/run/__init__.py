"""Commands for single runs."""
