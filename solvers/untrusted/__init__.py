"""What comes from outside: how its texts are quoted, its numbers read, and how much of it is taken."""
