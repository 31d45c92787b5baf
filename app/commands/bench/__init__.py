"""How fast it is here, and what a class would get."""
