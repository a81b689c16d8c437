"""Energy and momentum conserving time stepping (EECA) for pymunk spaces."""

from .closures import Closure, Dashpot, Midstep
from .contacts import Contacts
from .eeca import EECA
from .errors import UnsupportedFeature
from .invariants import Invariants, measure
from .native import Native
from .stepper import Stepper, StepReport

__all__ = [
    "EECA",
    "Closure",
    "Contacts",
    "Dashpot",
    "Invariants",
    "Midstep",
    "Native",
    "StepReport",
    "Stepper",
    "UnsupportedFeature",
    "measure",
]
