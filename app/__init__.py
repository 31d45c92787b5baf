"""What a person sees and types: command line, page and pictures. Imports solvers; never the reverse."""

__version__ = "0.2.0"
