"""warmup: compile all kernels now, not at the first steps."""

from __future__ import annotations

import time

from .closures.dashpot import Dashpot
from .closures.midstep import Midstep
from .closures.time_of_impact import TimeOfImpact
from .compiled import compiler
from .eeca import EECA, Closure
from .impacts.booking import flag_again
from .impacts.scene import EventLoop
from .space.sample import sample

_DT = 0.02  # s: bodies of the samples meet within a step


def warmup() -> float:
    """Compile all kernels now; seconds that took.

    Without it kernels are compiled, or read from the disk, at the first step of each closure. Machine code is kept on
    disk until the package, numba or Python changes: a warmup after that, say when a container is built, spares the
    first run some minutes of waiting; later ones take seconds. Nothing that the caller holds is touched.

        python -c "import eeca_pymunk as ep; print(ep.warmup())"
    """
    start = time.perf_counter()
    if compiler() is not None:
        closures: tuple[Closure, ...] = (TimeOfImpact(), Midstep(), Dashpot(1e4, 1.0))
        for kind, closure in [("disks", c) for c in closures] + [
            ("boxes", closures[0]),
            ("hooked", closures[0]),
            ("joints", closures[0]),
            ("joints", closures[1]),
        ]:
            stepper = EECA(sample(kind), closure)
            stepper.step(_DT)
            if isinstance(stepper._method, EventLoop):
                # Called only where lists outgrow their room within a step.
                flag_again(stepper._method.table)
    return time.perf_counter() - start
