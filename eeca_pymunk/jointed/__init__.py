"""Jointed: intervals of islands whose bodies have joints, and the contacts among these bodies.

In: an island of a scene (`..islands`), the arrays of its joints (`..joints`), an instant. Out: its bodies on parabolas
until the interval ends, joints and contacts with their impulses.

Open first `attempt.py`, the interval of an island, with `solve.py` and `lengths.py`, how long it may be,
`iteration.py`, which makes its contacts and components agree, `contact_laws.py`, the laws of the contacts,
`advance.py`, the motion under their impulses, `settling.py`, what becomes of those that are no solution, and
`bounded_rows.py`, bounded impulses of joints; `alone.py` is the interval of a component that is near no other shape.
`meet.py` finds the instant at which islands meet, on their `paths.py`; `ends.py` ends or shortens intervals.
`ledger.py` accounts for joints, `welds.py` for those that hold bodies still, `losses.py` for what contacts lose.
`component.py` steps one component (`gathered.py`). Its responses to impulses (`..newton.response`) are the columns of
contacts (`columns.py`) over groups of bodies (`groups.py`), which `broyden.py` updates; `..rows.laws` solves with them.
`projection.py` projects velocities onto joints after an interval, `correction.py` corrects penetration, `rest.py` puts
islands to rest. `..model.joints` names the arrays. A *free* island has no contact or joint with a body that impulses do
not move. A scene without joints calls nothing of this room.
"""
