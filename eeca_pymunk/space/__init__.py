"""The edge: all that reads or writes pymunk, and the only room that knows its private names.

In: a `pymunk.Space`, its bodies, shapes, settings, functions and handlers. Out: arrays, and the errors that refuse what
cannot be stepped. Back: the arrays of the end of a step, written into the space.

Open first `world.py`, the space as packed arrays (`layout.py`), and `checks.py`, what is refused. `bodies.py` and
`shapes.py` are the arrays of the simultaneous steppers, `twin.py` with `grown.py` finds their pairs by pymunk's own
detection. `hooks.py` calls what the user hung into the space, `sync.py` brings pymunk's shapes up to date after a step,
`measure.py` and `outlines.py` read it for energies and pictures. `private.py` has every private name of pymunk.
"""
