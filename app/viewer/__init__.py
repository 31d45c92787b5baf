"""All that knows the viewer and its websockets from inside: nothing else imports their inner modules."""
