"""The exception for scenes the package does not model."""

from __future__ import annotations


class UnsupportedFeature(ValueError):
    """The space holds something the stepper does not model.

    The message names the object and the remedy. It is raised before anything moves, so the space is as it was.
    """
