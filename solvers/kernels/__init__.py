"""All that works around the compiler, and the shape functions: nothing here knows of a scene."""
