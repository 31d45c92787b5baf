"""Studies: many scenes measured, one row each.

Scene -> Solver -> Result -> row -> table and pictures. ``grid`` makes tasks out of lists of values, ``row`` measures
one task, ``apart`` does that in a process of its own, ``places`` and ``cluster`` say where, ``execute`` sees that
every task ends as a row, ``store`` keeps rows safe on disk, ``series`` and ``fit`` read them, ``table`` writes them.
``family`` and ``advise`` look for the cheapest scene that meets a tolerance. ``aside`` does a whole sweep or search
in a process of its own while something else goes on.
"""
