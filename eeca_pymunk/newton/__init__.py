"""Newton: the implicit equations of one component of jointed bodies, and Newton's iteration for them.

In: a `Workspace` with the component's bodies, joints, limits that hold, and the length of a step. Out: velocities and
impulses that satisfy balance and joints to round-off, or False; or what the component answers to impulses.

Open first `rows.py`, the equations of all ten joints (`points.py`, `angles.py`, `springs.py`), then `solve.py`, the
iteration. `systems.py` has its linear systems, made of `entries.py`, `bounded.py` and `boxes.py` (bounded impulses),
which `banded.py` (bodies and rows together), `condensed.py` (bodies alone) and `dual.py` (rows alone) solve.
`motion.py` moves bodies by their velocities; `response.py` has the answer to impulses.
"""
