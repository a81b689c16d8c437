"""Energy and momentum conserving time stepping (EECA) for pymunk spaces.

`eeca_pymunk.render` draws pictures and films; it is imported at first use, because it imports matplotlib.
"""

from types import ModuleType

from .baselines.native import Native
from .baselines.newmark import Newmark
from .baselines.penalty import PenaltyEnergyMomentum
from .closures.dashpot import Dashpot
from .closures.midstep import Midstep
from .closures.time_of_impact import TimeOfImpact
from .datasets import Rollouts
from .eeca import EECA, Closure
from .energy.invariants import Invariants
from .energy.ledger import Ledger, LedgerTrace
from .errors import UnsupportedFeature
from .events import Events
from .recorder import record
from .recording import Recording
from .report import Contacts, RunReport, StepReport
from .rollouts import certify, rollout
from .space.bodies import measure
from .stepper import Stepper
from .sweep import SweepError, sweep
from .unmet import Unmet
from .warming import warmup

__all__ = [
    "EECA",
    "Closure",
    "Contacts",
    "Dashpot",
    "Events",
    "Invariants",
    "Ledger",
    "LedgerTrace",
    "Midstep",
    "Native",
    "Newmark",
    "PenaltyEnergyMomentum",
    "Recording",
    "Rollouts",
    "RunReport",
    "StepReport",
    "Stepper",
    "SweepError",
    "TimeOfImpact",
    "Unmet",
    "UnsupportedFeature",
    "certify",
    "measure",
    "record",
    "render",
    "rollout",
    "sweep",
    "warmup",
]


def __getattr__(name: str) -> ModuleType:
    # matplotlib takes longer to import than everything else, and only render needs it.
    if name == "render":
        from importlib import import_module

        return import_module(".render", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
