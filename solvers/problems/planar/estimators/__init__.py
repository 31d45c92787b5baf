"""Estimators of plane problems."""
