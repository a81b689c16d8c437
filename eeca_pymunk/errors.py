"""The package's own exceptions, each a ValueError."""

from __future__ import annotations


class UnsupportedFeature(ValueError):
    """The space holds something the stepper does not model.

    The message names the object and the remedy. It is raised before anything moves, so the space is as it was.
    """


class NotFiniteError(ValueError):
    """A body's state is NaN or infinite, or would be after the step. The space is as it was."""
