"""Landscapes: the error of a run as a function of one number of its scene, such as its cells.

One point of a landscape is a whole run, of which ``error_history`` keeps the largest errors until each time.
``history_runner`` computes it, ``parameter_values`` chooses the points, and ``landscape`` puts together what is known
of them. Only ``history_runner`` needs Taichi.
"""
