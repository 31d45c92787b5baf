"""The Cost tab: a visitor's runs, sweeps and searches in the background, and their chart of error against time."""
