"""The paper's three tables: their runs (``paper_tables``) and numbers (``table_runs``). No kernels."""
