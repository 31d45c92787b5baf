"""Studies: many scenes measured, one row each.

Scene -> Solver -> Result -> row -> table and pictures. ``grid`` makes tasks out of lists of values, ``row`` measures
one task, ``places`` says where, each in a process of its own, and sees that every task ends as a row, ``store`` keeps
rows safe on disk, ``fit`` reads them, ``summary`` writes them. ``stability``, ``coverage`` and ``tables`` are studies
with plans and documents of their own, ``sweep`` is one as a function. ``family`` and ``advise`` look for the
cheapest scene that meets a tolerance. ``jobs`` does a whole sweep or search in the background.
"""
