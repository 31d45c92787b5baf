"""Untrusted input: safe quoting of texts, parsing of numbers, and size limits."""
