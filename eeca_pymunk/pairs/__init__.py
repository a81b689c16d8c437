"""Pairs: who may meet.

In: the bounding circles of shapes, and where they are. Out: near lists, of every shape that moves those that it may
meet before one of them leaves its margin circle; `grid.py` makes a shape's list anew when it does.

Open first `lists.py`; `setup.py` chooses margins and lays the arrays out, whose columns `layout.py` names.
"""
