"""Hard cases: kinds of trouble that users of engines report, each with its own oracle; a matrix of passes.

A case runs a scene under a stepper and returns a figure; its limit is what the method promises. Open `case.py` first;
each other file has the cases of a kind, `matrix.py` runs them all under all steppers.
"""

from . import impacts, oblique, friction, moving, piles, crowds, guards, invariances, reports, joints, linked, meeting  # noqa: F401, I001  (order of the rows)
from .case import CASES, LONG, Case
from .matrix import figure, run

__all__ = ["CASES", "LONG", "Case", "figure", "run"]
