"""How steps are spread: one kernel for many on a thread, slabs side by side, or on a GPU all particles at once."""
