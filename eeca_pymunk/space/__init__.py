"""The edge: all that reads or writes pymunk."""
