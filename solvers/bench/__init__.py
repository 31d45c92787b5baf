"""The bench: how fast the solvers are, what each effect costs, and how long it takes to start.

``measure`` has the rates and the prices, against each problem's step without any optional code where it has one
(``solvers.problems.Problem.baseline``); ``gpu`` what a GPU gains where there is one; ``start`` the start-up and compile
times, both in fresh processes (``solvers.workers.worker_process``);
``limit`` has our rates over those of hand-written C++ (``cpp/``). ``bench`` puts it all together.
"""
