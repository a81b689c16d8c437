"""Islands that rest, slide, roll and pile up: one bounded solve per island and span of time, with a ledger that closes.

In: the bodies of one island (pose, velocity, mobility, acceleration), pairs of shapes that may touch, what is known of
their forces, a span h. Out: velocities at the end (each body's path is the parabola between), losses, and how far to
lift bodies out of each other. Open `step.py` first: gather rows (`contacts.py`), set targets (`targets.py`), see
whether it stands (`statics.py`), solve (`relax.py`), lock, book (`ledger.py`), lift (`lifting.py`), and remember
(`memory.py`).
"""
