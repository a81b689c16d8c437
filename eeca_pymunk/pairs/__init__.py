"""Pairs: who may meet.

In: the bounding circles of shapes, and where they are. Out: near lists, of every shape that moves those that it may
meet before one of them leaves its margin circle; `grid.py` makes a shape's list anew when it does,
from the places that shapes have in `cells.py`.

All shapes, disks and others, have their pairs from here. pymunk's arbiters of a private space of grown shapes would be
fewer (by a fifth for boxes), but cost 2 to 11 times as much at equal margins, as all are found anew when one has left:
`python -m comparisons detection` measures both, and checks that every pair that pymunk finds is in the lists.

Open first `lists.py`; `setup.py` chooses margins and lays the arrays out (records of `..model.shapes`).
"""
