"""Who may come in: addresses, the class code, and the log of what was refused."""
