"""Work against precision: error, drift and wall time of every stepper for many dt, on problems with exact solutions."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import numpy.typing as npt
import pymunk
from matplotlib.figure import Figure
from tqdm import tqdm

import eeca_pymunk as ep
import scenes
from comparisons import pool, runs
from comparisons.exact import Gas
from comparisons.output import Output, Row
from comparisons.runs import Make
from eeca_pymunk import render
from scenes import Scene

FloatArray = npt.NDArray[np.float64]
STEPS = (2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 1e-4, 1e-5)
# First order methods need no smaller ones to show it, and minutes each to take them: these with --full.
SMALLEST_OF_OTHERS = 5e-4
SEEDS = 20
TABLE_STEPS = (1e-2, 5e-3)
EECA = "EECA TimeOfImpact"
FLOOR = 1e-16  # m; where a picture draws an error of zero


@dataclass(frozen=True)
class Problem:
    """Scenes that are alike, with known ends: the error of a run is the largest over them.

    `build(i)` makes scene number i of `count`; `duration` in s.
    """

    name: str
    duration: float
    count: int
    build: Callable[[int], Scene]


def gas(count: int, radius: float, duration: float, seed: int) -> Scene:
    """A gas with its exact end."""
    scene = scenes.build("gas", count=count, radius=radius, seed=seed, duration=duration)
    exact = Gas(
        np.array([b.position for b in scene.bodies]), np.array([b.velocity for b in scene.bodies]),
        np.full(count, radius), np.ones(count),
    )  # fmt: skip
    exact.run(duration)
    return replace(scene, exact=lambda t: exact.position)


def generic_carom(seed: int) -> Scene:
    """A carom that starts anywhere in any direction."""
    rng = np.random.default_rng(seed)
    x, angle = rng.uniform(0.1, 0.9, 2), rng.uniform(0.0, 2.0 * np.pi)
    v = 5.0 * np.array([np.cos(angle), np.sin(angle)])
    return scenes.build("carom", position=tuple(x.tolist()), velocity=tuple(v.tolist()))


def problems() -> list[Problem]:
    """The problems, each with an end that tells steppers apart: chaos has not hidden it yet."""
    found = [
        Problem("carom", 1.0, 1, lambda i: scenes.build("carom")),
        Problem("carom, generic starts", 1.0, 3, generic_carom),
        Problem("cradle i", 0.02, 1, lambda i: scenes.build("cradle", hypothesis="i")),
        Problem("cradle ii", 0.02, 1, lambda i: scenes.build("cradle", hypothesis="ii")),
        Problem("ball", 2.0, 1, lambda i: scenes.build("ball", height=0.5)),
    ]
    for duration in (0.1, 0.2, 0.4):
        found.append(Problem(f"gas 20, T={duration:g}", duration, 3, _gas_of(20, 0.03, duration)))
    found.append(Problem("gas 200, T=0.04", 0.04, 1, _gas_of(200, 0.02, 0.04)))
    return found


def _gas_of(count: int, radius: float, duration: float) -> Callable[[int], Scene]:
    return lambda seed: gas(count, radius, duration, seed)


@dataclass(frozen=True)
class Point:
    """One stepper on one problem at one dt: largest error (m), largest energy drift, wall time of a run (s)."""

    stepper: str
    dt: float
    error: float
    drift: float
    wall: float


def measure(problem: Problem, name: str, make: Make, dt: float) -> Point:
    """Run all scenes of a problem."""
    error = drift = wall = 0.0
    for i in range(problem.count):
        result = runs.run(problem.build(i), make, dt=dt, duration=problem.duration, label=f"{problem.name}, {name}")
        # A run that blew up has no end.
        error = np.inf if result.failed is not None else max(error, result.error)
        drift = max(drift, result.energy_drift)
        wall += 1e-3 * result.milliseconds * round(problem.duration / dt) / problem.count
    return Point(name, dt, error, drift, wall)


def jobs(full: bool) -> Iterator[tuple[Problem, str, Make, float]]:
    """All runs of the comparison."""
    for problem in problems():
        stiffness = problem.build(0).stiffness
        steppers = runs.steppers(stiffness)
        steppers["energy-momentum"] = partial(_penalty, stiffness)
        for name, make in steppers.items():
            to_the_end = full or name.startswith("native") or name == EECA
            for dt in STEPS:
                if dt <= problem.duration and (to_the_end or dt >= SMALLEST_OF_OTHERS):
                    yield problem, name, make, dt


def _penalty(stiffness: float, space: pymunk.Space) -> ep.Stepper:
    return ep.PenaltyEnergyMomentum(space, stiffness, sync=False)


def run(output: Output, full: bool, workers: int = 1) -> None:
    """Print the tables; write CSV and a picture for each problem. Runs that are timed go one after the other."""
    output.parameters({"dt": STEPS, "problems": [p.name for p in problems()], "seeds": SEEDS})
    points: dict[str, list[Point]] = {p.name: [] for p in problems()}
    for problem, name, make, dt in tqdm(list(jobs(full)), desc="work_precision", unit="run", disable=None):
        points[problem.name].append(measure(problem, name, make, dt))
    rows: list[Row] = [
        {
            "problem": title, "stepper": p.stepper, "dt (s)": p.dt, "error (m)": p.error,
            "max |dE/E|": p.drift, "run (ms)": 1e3 * p.wall,
        }
        for title, found in points.items() for p in found
    ]  # fmt: skip
    output.table("Error of positions at the end, energy drift, wall time of a run", rows, "all")
    output.table(
        "EECA TimeOfImpact against native at its best (default or tuned, any dt)",
        [summary(problem, found) for problem, found in points.items()],
        "summary",
    )
    output.table(
        f"Gas, 20 disks, r = .03, T = .4, {SEEDS} seeds: error of positions against the exact end", seeds(workers)
    )
    for title, found in points.items():
        output.picture(_picture(title, found), title.replace(", ", "_").replace(" ", "_").replace("=", ""))


def summary(problem: str, points: list[Point]) -> Row:
    """How much faster EECA is at native's best error, and how much smaller its error is within native's time there."""
    native = min((p for p in points if p.stepper.startswith("native")), key=lambda p: p.error)
    eeca = [p for p in points if p.stepper == EECA]
    as_good = min((p for p in eeca if p.error <= native.error), key=lambda p: p.wall, default=None)
    in_time = min((p for p in eeca if p.wall <= native.wall), key=lambda p: p.error, default=None)
    return {
        "problem": problem,
        "native best (m)": native.error,
        "at dt (s)": native.dt,
        "run (ms)": 1e3 * native.wall,
        "EECA (ms)": None if as_good is None else 1e3 * as_good.wall,
        "x faster": None if as_good is None else native.wall / as_good.wall,
        "EECA in that time (m)": None if in_time is None else in_time.error,
        "x smaller": None if in_time is None else native.error / max(in_time.error, FLOOR),
    }


def _seed_steppers() -> dict[str, Make]:
    return {
        EECA: runs.eeca(ep.TimeOfImpact()), "EECA Midstep": runs.eeca(ep.Midstep()),
        "native default": runs.native(), "native tuned 50": runs.native(50),
    }  # fmt: skip


def one_seed(case: tuple[str, float, int]) -> tuple[float, float]:
    """Error and drift of a stepper, at a dt, from a start of the gas."""
    name, dt, seed = case
    result = runs.run(gas(20, 0.03, 0.4, seed), _seed_steppers()[name], dt=dt, duration=0.4, label=name)
    return result.error, result.energy_drift


def seeds(workers: int = 1) -> list[Row]:
    """Twenty starts of the gas at large steps."""
    kinds = [(name, dt) for dt in TABLE_STEPS for name in _seed_steppers()]
    found = pool.over(one_seed, [(*kind, seed) for kind in kinds for seed in range(SEEDS)], workers)
    rows: list[Row] = []
    for i, (name, dt) in enumerate(kinds):
        errors, drifts = zip(*found[i * SEEDS : (i + 1) * SEEDS], strict=True)
        rows.append({
            "stepper": name, "dt (s)": dt, "largest error (m)": max(errors),
            "median error (m)": float(np.median(errors)), "max |dE/E|": max(drifts),
        })  # fmt: skip
    return rows


def _picture(problem: str, points: list[Point]) -> Figure:
    figure = render.figure(10.0, 4.5)
    axes = figure.subplots(1, 2, sharey=True)
    for name in dict.fromkeys(p.stepper for p in points):
        mine = [p for p in points if p.stepper == name and np.isfinite(p.error)]
        error = [max(p.error, FLOOR) for p in mine]
        style = {"color": "black", "linewidth": 2.0} if name == EECA else {"linewidth": 1.0}
        axes[0].loglog([p.wall for p in mine], error, "o-", markersize=4, label=name, **style)
        axes[1].loglog([p.dt for p in mine], error, "o-", markersize=4, **style)
    axes[0].set(xlabel="wall time of a run (s)", ylabel="error of positions (m)")
    axes[1].set(xlabel="dt (s)")
    figure.legend(loc="outside right upper", fontsize=8)
    figure.suptitle(f"Work against precision: {problem}")
    return figure
