"""How often estimators are right: runs drawn at random, what is said of each, and how often that was so."""
