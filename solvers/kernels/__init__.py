"""Workarounds for the compiler, and the shape functions, independent of scenes."""
