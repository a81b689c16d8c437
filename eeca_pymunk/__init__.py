"""Energy and momentum conserving time stepping (EECA) for pymunk spaces.

`eeca_pymunk.render` draws; it is a module of its own because it imports matplotlib.
"""

from types import ModuleType

from .closures import Dashpot, Midstep
from .eeca import EECA, Closure
from .errors import UnsupportedFeature
from .geometry import Contacts
from .invariants import Invariants, measure
from .native import Native
from .newmark import Newmark
from .penalty import PenaltyEnergyMomentum
from .recording import Recording, record
from .stepper import Stepper, StepReport
from .time_of_impact import TimeOfImpact

__all__ = [
    "EECA",
    "Closure",
    "Contacts",
    "Dashpot",
    "Invariants",
    "Midstep",
    "Native",
    "Newmark",
    "PenaltyEnergyMomentum",
    "Recording",
    "StepReport",
    "Stepper",
    "TimeOfImpact",
    "UnsupportedFeature",
    "measure",
    "record",
    "render",
]


def __getattr__(name: str) -> ModuleType:
    # matplotlib takes longer to import than everything else: only who draws pays for it.
    if name == "render":
        from importlib import import_module

        return import_module(".render", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
