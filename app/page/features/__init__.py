"""What the page can do beside showing a run: one folder a feature, with its panel."""
