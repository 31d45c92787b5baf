"""Renderers of marks: the viewer and pictures; the offline player has a script of its own."""
