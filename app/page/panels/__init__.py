"""The page's panels: what a visitor sets and reads beside the stage."""
