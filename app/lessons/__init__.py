"""Lessons: a file each in ``lessons/``, read, checked, marked and shown."""
