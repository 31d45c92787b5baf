"""Everything that depends on internals of the viewer and its websockets; no other package imports these."""
