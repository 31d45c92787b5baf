"""Studies: many runs of one problem, and what they tell about accuracy and cost."""
