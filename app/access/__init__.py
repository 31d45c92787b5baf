"""Access control: allowed hosts, the class code, limits per network, and the log of refusals."""
