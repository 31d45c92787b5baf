"""The lesson player beside the stage."""
