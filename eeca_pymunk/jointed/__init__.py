"""Jointed: islands whose bodies are held by joints: their intervals, and contacts among them.

In: an island of a scene (`..islands`), the arrays of its joints (`..joints`), an instant. Out: its bodies on parabolas
until the interval ends, joints and contacts with their impulses.

Open first `solve.py`, the interval of an island, with `lengths.py`, how long it is, `press.py`, its contacts,
`advance.py`, the motion under their impulses, `alone.py`, of what meets nobody, and `bounded.py`, bounded impulses of
joints (`motors.py`); `meet.py` ends intervals where islands meet, `ledger.py` accounts for joints.
`component.py` steps what hangs together by joints (`gathered.py`) and finds how it answers impulses; `groups.py`,
`columns.py` has these answers, `laws.py` the contacts' laws with them (`..rows.homotopy`); `lifting.py` lifts overlaps.
`..model.joints` names the arrays. A scene without joints calls nothing of this room.
"""
