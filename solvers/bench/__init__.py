"""The bench: how fast the solvers are, what each effect costs, and how long it takes to start.

``measure`` has the rates and the prices, ``stripped_bar`` and ``stripped_ring`` the steps without any optional code
against which an effect that is off is measured, ``start`` the start-up and compile times, ``example`` the public
example beside them, ``apart`` the processes in which these two are measured, and ``bench`` puts it all together.
"""
