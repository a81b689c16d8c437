"""Prediction: when shapes meet next, if nothing else happens to their bodies.

In: bodies on their paths (`..model.bodies`), near lists. Out: for each body the instant and partner of its next event,
in a heap. Open `next_event.py` first: the next event of a body, from `impact_times.py` (closed forms in `roots.py` and
`circles.py`, shapes that turn in `turning.py`, bounds until when shapes need no search in `bounds.py`); `disks.py` does
the same for lone disks, `scheduling.py` chooses which bodies to predict, `heap.py` is the queue.
"""
