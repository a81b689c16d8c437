"""Prediction: when shapes meet next if no impulse acts before.

In: bodies on their paths (`..model.bodies`), near lists. Out: for each body the instant and partner of its next event,
in a heap. Open `next_event.py` first: the next event of a body, from `impact_times.py` (closed forms in `roots.py` and
`circles.py`, shapes that rotate in `search.py` with the bounds of `axes.py`, bounds that make a search unnecessary in
`bounding_circles.py`). `disks.py` does the same for single disks, `scheduling.py` selects the bodies to predict,
`heap.py` is the queue, `work.py` limits the work of a step.

Side effect: searches for thin shapes note the side on which they are (`sides.py`, `..geometry.sides`).
"""
