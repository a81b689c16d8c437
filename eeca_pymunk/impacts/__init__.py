"""Impacts: when shapes meet.

In: the arrays of `layout`, in which every body has a path of its own. Out: instants counted from the start of the step.

Open first `times.py`, where `meet` tells when two shapes touch next. Its parts: `roots.py` closed forms, `circles.py`
circles against circles and static outlines, `turning.py` shapes that turn.
"""
