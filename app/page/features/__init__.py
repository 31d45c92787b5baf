"""Features of the page beside showing a run: one folder each, with its panel."""
