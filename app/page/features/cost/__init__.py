"""What accuracy costs, on the page: a visitor's runs, sweeps and searches behind the page, and their picture."""
