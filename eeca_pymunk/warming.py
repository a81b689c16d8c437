"""warmup: compile all kernels now, not at the first steps."""

from __future__ import annotations

import time

from .closures.dashpot import Dashpot
from .closures.midstep import Midstep
from .closures.time_of_impact import TimeOfImpact
from .eeca import EECA, Closure
from .space.sample import sample

_DT = 0.02  # s: bodies of the sample meet within a step


def warmup() -> float:
    """Compile all kernels now; seconds that took.

    Without it kernels are compiled, or read from the disk, at the first step of each closure. Machine code is kept on
    disk until the package, numba or Python changes: a warmup after that, say when a container is built, spares the
    first run some minutes of waiting; later ones take seconds. Nothing that the caller holds is touched.

        python -c "import eeca_pymunk as ep; print(ep.warmup())"
    """
    start = time.perf_counter()
    closures: tuple[Closure, ...] = (TimeOfImpact(), Midstep(), Dashpot(1e4, 1.0))
    for closure in closures:
        for turning in (False, True) if isinstance(closure, TimeOfImpact) else (False,):
            stepper = EECA(sample(turning), closure, sync=False)
            stepper.step(_DT)
    return time.perf_counter() - start
