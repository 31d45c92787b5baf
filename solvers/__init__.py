"""What is computed: scenes, solvers, error estimators and results. Nothing here imports the page."""
