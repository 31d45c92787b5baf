"""What the estimators of plane problems share."""
