"""Jointed: islands whose bodies are held by joints: their intervals, and contacts among them.

In: an island of a scene (`..islands`), the arrays of its joints (`..joints`), an instant. Out: its bodies on parabolas
until the interval ends, joints and contacts with their impulses.

Open first `solve.py`, the interval of an island, with `lengths.py`, how long it is, `press.py`, its contacts,
`advance.py`, the motion under their impulses, and `bounded.py`, bounded impulses of joints (`motors.py`); `alone.py` is
the interval of a component that meets no other shape. `meet.py` ends intervals where islands meet, `ledger.py` accounts for joints.
`component.py` steps what hangs together by joints (`gathered.py`) and finds how it answers impulses; `groups.py`,
`columns.py` has these answers (the contacts' laws with them: `..rows.laws`); `lifting.py` lifts overlaps.
`..model.joints` names the arrays. A scene without joints calls nothing of this room.
"""
