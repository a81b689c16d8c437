"""Energy and momentum conserving time stepping (EECA) for pymunk spaces.

`eeca_pymunk.render` draws; it is a module of its own because it imports matplotlib.
"""

from types import ModuleType

from .baselines.native import Native
from .baselines.newmark import Newmark
from .baselines.penalty import PenaltyEnergyMomentum
from .closures.dashpot import Dashpot
from .closures.midstep import Midstep
from .closures.time_of_impact import TimeOfImpact
from .eeca import EECA, Closure
from .energy.invariants import Invariants
from .energy.ledger import Ledger
from .energy.ledger_trace import LedgerTrace
from .errors import UnsupportedFeature
from .recording import Recording, record
from .report import Contacts, StepReport, Unmet
from .space.measure import measure
from .stepper import Stepper
from .sweep import SweepError, sweep
from .warming import warmup

__all__ = [
    "EECA",
    "Closure",
    "Contacts",
    "Dashpot",
    "Invariants",
    "Ledger",
    "LedgerTrace",
    "Midstep",
    "Native",
    "Newmark",
    "PenaltyEnergyMomentum",
    "Recording",
    "StepReport",
    "Stepper",
    "SweepError",
    "TimeOfImpact",
    "Unmet",
    "UnsupportedFeature",
    "measure",
    "record",
    "render",
    "sweep",
    "warmup",
]


def __getattr__(name: str) -> ModuleType:
    # matplotlib takes longer to import than everything else: only who draws pays for it.
    if name == "render":
        from importlib import import_module

        return import_module(".render", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
