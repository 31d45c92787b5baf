"""The paper's three tables: which runs they take (``plan``) and what their numbers are (``document``). No kernels."""
