"""Where and when the error of a run of the bar was made: its budget traced back, in numpy, beside the solver."""
