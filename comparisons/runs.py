"""Running a scene under several steppers and measuring error, drift and time in the same way for each."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pymunk
from tqdm import tqdm

import eeca_pymunk as ep
from comparisons.output import Row
from eeca_pymunk.baselines.native import tune
from eeca_pymunk.energy.invariants import Invariants
from eeca_pymunk.errors import NotFiniteError
from eeca_pymunk.recorder import step_count
from eeca_pymunk.space.bodies import Bodies
from scenes import Scene

FloatArray = npt.NDArray[np.float64]
Make = Callable[[pymunk.Space], ep.Stepper]
BLOWN_UP = 100.0  # change of the energy relative to the start
Observe = Callable[[int, float, Scene, ep.StepReport | None, Invariants], None]


def native(iterations: int | None = None) -> Make:
    """Native pymunk: as shipped (10 iterations, slop .1, persistence 3), or tuned with so many iterations."""

    def make(space: pymunk.Space) -> ep.Stepper:
        if iterations is not None:
            tune(space, iterations)
        return ep.Native(space)

    return make


def eeca(closure: ep.Closure, *, sync: bool = False) -> Make:
    """EECA with a closure. Comparisons query no shapes: without `sync` a step does only what they need."""
    return lambda space: ep.EECA(space, closure, sync=sync)


def steppers(stiffness: float, damping_ratios: tuple[float, ...] = (200.0,), thousand: bool = False) -> dict[str, Make]:
    """The steppers every comparison runs, by the names its table shows; natives with their iteration counts."""
    found: dict[str, Make] = {
        "EECA TimeOfImpact": eeca(ep.TimeOfImpact()),
        "EECA Midstep": eeca(ep.Midstep()),
    }
    for xi in damping_ratios:
        found[f"EECA Dashpot xi={xi:g}"] = eeca(ep.Dashpot(stiffness, xi))
    found["native default"] = native()
    found["native tuned 50"] = native(50)
    if thousand:
        found["native tuned 1000"] = native(1000)
    found["trapezoidal"] = lambda space: ep.Newmark.trapezoidal(space, stiffness, sync=False)
    found["max dissipation"] = lambda space: ep.Newmark.max_dissipation(space, stiffness, sync=False)
    return found


@dataclass
class Run:
    """Measures of one run. Drifts are the largest on the way, relative to the start; `closed` systems have no walls.

    `error` is the largest distance of a body from the exact solution at the end, NaN where none is known;
    `milliseconds` is the wall time of a step. `failed` tells at which time the state stopped being finite.
    """

    error: float
    energy_drift: float
    energy_end: float
    momentum_drift: float
    milliseconds: float
    failed: float | None

    def columns(self, closed: bool) -> Row:
        """The columns that every comparison's table has."""
        return {
            "error (m)": self.error,
            "max |dE/E|": self.energy_drift,
            "dE/E at end": self.energy_end,
            "max |dp|/p": self.momentum_drift if closed else math.nan,
            "ms/step": self.milliseconds,
            "note": "" if self.failed is None else f"stopped at {self.failed:.3g} s",
        }


def run(
    scene: Scene,
    make: Make,
    *,
    dt: float | None = None,
    duration: float | None = None,
    label: str = "",
    observe: Observe | None = None,
    every: int = 1,
) -> Run:
    """Step `scene`, and measure it after `every` so many steps: `observe(step, time, scene, report, invariants)` is
    called then, and at the start, outside the clock. A run stops where its energy has blown up, as that of the penalty
    baselines may."""
    dt = scene.dt if dt is None else dt
    duration = scene.duration if duration is None else duration
    count = step_count(duration, dt)
    stepper, bodies = make(scene.space), Bodies(scene.space)

    def now() -> Invariants:
        state = bodies.gather()
        assert state is not None  # scenes keep their bodies
        return bodies.invariants(state, scene.space.gravity)

    start = now()
    scale_p = float(np.sum(bodies.mass[bodies.dynamic] * speeds(scene))) or 1.0
    drift = momentum = wall = 0.0
    end, failed = start, None
    if observe:
        observe(0, 0.0, scene, None, start)
    for k in tqdm(range(1, count + 1), desc=label, unit="step", leave=False, mininterval=0.5, disable=None):
        clock = time.perf_counter()
        try:
            report = stepper.step(dt)
        except NotFiniteError:  # overflow: refused, as it should be
            failed = k * dt
            break
        wall += time.perf_counter() - clock
        if k % every and k < count:
            continue
        end = now()
        drift = max(drift, abs(end.energy / start.energy - 1.0))
        momentum = max(momentum, float(np.abs(end.linear_momentum - start.linear_momentum).max()) / scale_p)
        if observe:
            observe(k, k * dt, scene, report, end)
        if drift > BLOWN_UP:
            failed = k * dt
            break
    exact = scene.exact(count * dt)
    position = np.array([b.position for b in scene.bodies])
    error = math.nan if exact is None or failed is not None else float(np.linalg.norm(position - exact, axis=1).max())
    return Run(error, drift, end.energy / start.energy - 1.0, momentum, 1e3 * wall / count, failed)


def speeds(scene: Scene) -> FloatArray:
    """(N,) speed of the scene's bodies now, m/s."""
    result: FloatArray = np.linalg.norm(np.array([b.velocity for b in scene.bodies]), axis=1)
    return result


def slope(x: FloatArray, y: FloatArray) -> float:
    """Least-squares slope of log y against log x."""
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])
