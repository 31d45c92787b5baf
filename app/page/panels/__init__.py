"""The page's panels: settings and readings beside the stage."""
