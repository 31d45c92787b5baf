"""A scene run from its start to its end: the result, and how long it took."""
