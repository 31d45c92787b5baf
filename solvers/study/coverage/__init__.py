"""Reliability of estimators: random runs, their estimates, and how often these were right."""
