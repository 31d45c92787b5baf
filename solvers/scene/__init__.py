"""What defines a run: the scene, its rules, and the names of everything that it may call for. Needs no Taichi."""
