"""The package's own exceptions, each a ValueError."""

from __future__ import annotations


class UnsupportedFeature(ValueError):
    """The space contains a feature that the stepper does not support.

    The message names the object and the remedy. It is raised before the step starts; the space is unchanged.
    """


class NotFiniteError(ValueError):
    """A body's state is NaN or infinite, or would be after the step. The space is unchanged."""
