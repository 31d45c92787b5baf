"""The bench: how fast the solvers are, what each effect costs, and how long it takes to start.

``measure`` has the rates and the prices, ``stripped_bar`` and ``stripped_ring`` the steps without any optional code that
the price of a switched-off effect is measured against, ``start`` the start-up and compile times, ``example`` the public
example beside them, and ``bench`` puts it all together.
"""
