"""Jointed: bodies held by joints in the event loop: their islands, contacts among them, and impacts on them.

In: the arrays of a scene (`..impacts`) and of its joints (`..joints`). Out: the same at the end of a step.

Open first `loop.py`, the step; then `solve.py`, the interval of an island, with `lengths.py`, how long it is,
`press.py`, its contacts, `advance.py`, the motion under their impulses, `alone.py`, of what meets nobody, and
`bounded.py`, bounded impulses of joints (`motors.py`); `meet.py` and `strike.py`, an impact at one instant.
`component.py` steps what hangs together by joints (`gathered.py`) and finds how it answers impulses; `groups.py`,
`columns.py` and `newton.py` solve contact laws with these answers in the place of masses; `lifting.py` lifts overlaps.
`..model.joints` names the arrays, `scene.py` owns them. A scene without joints knows nothing of this room.
"""
