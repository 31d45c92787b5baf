"""Elastic bodies of mapped patches whose exact solution is unknown: MPM runs with error bars from two companions."""
