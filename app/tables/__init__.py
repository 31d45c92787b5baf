"""Tables on disk: finished rows kept for the next start, Markdown and pictures made from a table's JSON object."""
