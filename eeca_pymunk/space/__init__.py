"""The edge: all that reads or writes pymunk, and the only room that knows its private names.

In: a `pymunk.Space`, its bodies, shapes, settings, functions and handlers. Out: arrays, and the errors that refuse what
cannot be stepped. Back: the arrays of the end of a step, written into the space.

Open first `world.py`, the space as packed arrays (`packing.py` fills them), and `checks.py`, what is refused. `sync.py`
brings pymunk's shapes up to date after a step, `hooks.py` calls what the user hung into the space, `noticed.py` hears
what is edited in place, `private.py` has every private name of pymunk. `bodies.py` and `shapes.py` read bodies and
shapes; `measure.py`, `outlines.py` and `describe.py` read a space for energies, for pictures, and for one line of text.
"""
