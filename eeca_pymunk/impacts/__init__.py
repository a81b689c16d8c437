"""Impacts: bodies on their paths from one computed time of impact to the next.

In: the packed arrays of a world (`..layout`) at the start of a step. Out: the same at its end, and a log of impulses.

Open first `step.py`, the stages of a step; then `loop.py`, the queue of events. `due.py` chooses who is forecast;
`forecast.py` says when a body's next event is due, `lone.py` for most lone disks, from `times.py` (closed forms in
`roots.py` and `circles.py`, shapes that turn in `turning.py`, until when shapes need no look in `apart.py`);
`strike.py` says what an impact does, alone or in a block (`block.py`, `collide.py`). `scene.py` owns the arrays, whose
columns `layout.py` names.

Contacts that last: `settle.py` puts what rests at the start of a step into islands (`islands.py`); `spans.py` solves
each over a span of time (`coming.py` says of which pairs and how long, `..sustained` is the solve); `booking.py` books
what it has done when it ends or is cut by a hit; `calm.py` finds the islands that stand, and `still.py` spares them;
`parting.py` lets some bodies of an island stand while others move, and `carrying.py` sees whether they carry these;
`crammed.py` holds what was put into one another until it is apart.
`together.py` is the step in which all contacts act at once.
"""
