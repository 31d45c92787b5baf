"""The practical limit: the same step in C++ by hand, compiled where it is measured, and our rates as ratios to it.

``bar.cpp`` and ``ring.cpp`` are fused, vectorised and have nothing but the method: what a person reaches who writes one
method for one processor. ``program`` compiles and runs them, ``ratios`` holds the solvers against them, ``history``
keeps what was found, an entry a line.
"""
