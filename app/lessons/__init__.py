"""Lessons: one file each in ``lessons/``; reading, checking and marking them."""
