"""Pairs: which shapes may meet, and which pass one another's corners.

In: the bounding circles of shapes, and their positions. Out: for each moving shape a near list, the shapes that it may
meet before one of them leaves its margin circle. The centre of a shape's bounding circle may move by the margin from
the centre of the margin circle, which is fixed in space; when it leaves that circle, `grid.py` renews the list, from
the places of shapes in `cells.py`. CONTRIBUTING compares near lists with pymunk's detection.

Open first `rules.py`; `setup.py` makes the arrays (records of `..model.shapes`), and `margins.py` chooses margins;
`walls.py` finds static neighbours; `candidates.py` lists the pairs of one step. `passing.py` tells which pairs lie
flush where their closest points would let them meet.
"""
