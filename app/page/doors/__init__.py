"""Who may come in, and what may be said: addresses, the class code, and every message of a browser."""
