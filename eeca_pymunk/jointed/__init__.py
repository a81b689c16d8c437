"""Jointed: islands whose bodies are held by joints: their intervals, and contacts among them.

In: an island of a scene (`..islands`), the arrays of its joints (`..joints`), an instant. Out: its bodies on parabolas
until the interval ends, joints and contacts with their impulses.

Open first `solve.py`, the interval of an island, with `lengths.py`, how long it is, `press.py`, its contacts,
`advance.py`, the motion under their impulses, and `bounded_rows.py`, bounded impulses of joints (`motors.py`);
`alone.py` is the interval of a component that meets no other shape. `meet.py` ends intervals where islands meet,
`ledger.py` accounts for joints, `losses.py` has what contacts lose. `component.py` steps one component (`gathered.py`)
and finds its response to impulses; `rest.py` puts islands to rest; `groups.py`, `columns.py` has these responses (the
contacts' laws with them: `..rows.laws`); `lifting.py` lifts overlaps.
`..model.joints` names the arrays. A scene without joints calls nothing of this room.
"""
