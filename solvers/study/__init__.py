"""Studies: measurements of many scenes, one row each.

Scene -> Solver -> Result -> row -> table and pictures. ``parameter_grid`` makes tasks from lists of values, ``row``
measures one task, ``executors`` run tasks in processes and turn every task into a row, ``row_store`` keeps rows safe on
disk, ``convergence`` analyses them, ``summary`` writes them. ``stability``, ``coverage`` and ``tables`` are studies
with plans and documents of their own, ``sweep`` is one as a function. ``refinement_family`` and ``advise`` search for
the cheapest scene that meets a tolerance. ``background_jobs`` runs a whole sweep or search in the background.
``landscape`` is the error of a run over each slider of the page.
"""
