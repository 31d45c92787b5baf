"""The Material Point Method and its error estimates, headless: Scene -> Solver -> Result."""

import os

# For Taichi, whoever imports it first: no announcement, and no asking a server for news at every start.
os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")
os.environ["TI_SKIP_VERSION_CHECK"] = "ON"
