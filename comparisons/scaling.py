"""Scaling: ms per step and us per collision of each stepper against native, for 100 to 16 000 disks and the hopper."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
import pymunk
from matplotlib.figure import Figure
from tqdm import tqdm

import eeca_pymunk as ep
import scenes
from comparisons.output import Output, Row
from comparisons.runs import slope
from eeca_pymunk import eeca, render
from eeca_pymunk.array_stepper import ArrayStepper
from eeca_pymunk.space.twin import MarginTwin
from scenes import Scene

COUNTS = (100, 1000, 4000, 16_000)
STEPS = (2e-4, 1e-3)
HOPPER_DT, HOPPER_WARM = 5e-4, 600  # steps until the disks have met the walls and each other
WARM = 10  # steps before the clock runs: lists are made, caches are filled
SECONDS = 1.5  # of wall time that each measurement may take
LEAST, MOST = 5, 400  # steps of a measurement


@dataclass
class Clock:
    """Wall time spent in the parts of a step (s)."""

    parts: dict[str, float] = field(default_factory=dict)

    def timed(self, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """`function`, its time added to a part."""

        def call(*args: Any, **kwargs: Any) -> Any:
            clock = time.perf_counter()
            try:
                return function(*args, **kwargs)
            finally:
                self.parts[name] = self.parts.get(name, 0.0) + time.perf_counter() - clock

        return call


@contextmanager
def parts() -> Iterator[Clock]:
    """Measures detection and transfer of the array steppers; what is left of a step is solving."""
    clock = Clock()
    watched: list[tuple[type, str, str]] = [
        (MarginTwin, "candidates", "detect"), (MarginTwin, "widen", "detect"),
        (ArrayStepper, "_gather", "transfer"), (ArrayStepper, "_scatter", "transfer"),
    ]  # fmt: skip
    originals = [(owner, name, getattr(owner, name)) for owner, name, _ in watched]
    try:
        for owner, name, part in watched:
            setattr(owner, name, clock.timed(part, getattr(owner, name)))
        yield clock
    finally:
        for owner, name, original in originals:
            setattr(owner, name, original)


def closures(count: int) -> dict[str, tuple[eeca.Closure, bool]]:
    """Closures to measure, with `sync` or without; the simultaneous ones only where a step stays affordable."""
    found: dict[str, tuple[eeca.Closure, bool]] = {
        "EECA TimeOfImpact": (ep.TimeOfImpact(), False),
        "EECA TimeOfImpact, sync": (ep.TimeOfImpact(), True),
        "EECA Midstep": (ep.Midstep(), False),
    }
    if count <= 1000:
        found["EECA Dashpot xi=200"] = (ep.Dashpot(1e6, 200.0), False)
    return found


def measure(stepper: ep.Stepper, dt: float, warm: int) -> tuple[float, int]:
    """Seconds per step, and how many steps were measured."""
    for _ in range(warm):
        stepper.step(dt)
    steps, begin = 0, time.perf_counter()
    while steps < LEAST or (time.perf_counter() - begin < SECONDS and steps < MOST):
        stepper.step(dt)
        steps += 1
    return (time.perf_counter() - begin) / steps, steps


def case(build: Callable[[], Scene], count: int, dt: float, warm: int) -> list[Row]:
    """All steppers on one scene, and their ratios to both natives."""
    seconds: dict[str, float] = {}
    shares: dict[str, Row] = {}
    scene = build()
    radius = min(shape.radius for shape in scene.space.shapes if isinstance(shape, pymunk.Circle))
    for name, hashed in (("native", False), ("native, hash", True)):
        scene = build()
        if hashed:
            scene.space.use_spatial_hash(3.0 * radius, 2 * count)
        seconds[name] = measure(ep.Native(scene.space), dt, warm)[0]
    collisions = 0.0
    for name, (closure, sync) in closures(count).items():
        scene = build()
        stepper = ep.EECA(scene.space, closure, sync=sync)
        for _ in range(warm):
            stepper.step(dt)
        with parts() as clock:
            seconds[name], steps = measure(stepper, dt, 0)
        total = seconds[name] * steps
        detect, transfer = clock.parts.get("detect", 0.0) / total, clock.parts.get("transfer", 0.0) / total
        shares[name] = {
            "detect %": 100 * detect,
            "solve %": 100 * (1 - detect - transfer),
            "transfer %": 100 * transfer,
        }
        if name == "EECA TimeOfImpact":
            reports = [stepper.step(dt) for _ in range(LEAST)]
            collisions = float(np.mean([len(r.contacts) for r in reports]))
    empty: Row = {"detect %": None, "solve %": None, "transfer %": None}
    return [
        {
            "scene": scene.name, "N": count, "dt (s)": dt, "stepper": name, "ms/step": 1e3 * wall,
            "us/collision": 1e6 * wall / collisions if collisions else None,
            "x native": wall / seconds["native"], "x native, hash": wall / seconds["native, hash"],
            **shares.get(name, empty),
        }
        for name, wall in seconds.items()
    ]  # fmt: skip


def run(output: Output, full: bool) -> None:
    """Print the tables; write CSV and a picture."""
    output.parameters({"N": COUNTS, "packing": 0.3, "dt": STEPS, "hopper dt": HOPPER_DT})
    rows: list[Row] = []
    for count in tqdm(COUNTS, desc="scaling", unit="N", disable=None):
        for dt in STEPS:
            rows += case(partial(scenes.build, "gas", count=count), count, dt, WARM)
    output.table("Elastic gas in a box, cost at equal dt", rows, "gas")
    hopper = case(partial(scenes.build, "hopper"), 665, HOPPER_DT, HOPPER_WARM)
    output.table(f"Hopper, from step {HOPPER_WARM} on", hopper, "hopper")
    output.table("Slope of the cost in N, from 1000 disks on", _slopes(rows), "slope")
    output.picture(_picture(rows))


def _series(rows: list[Row], dt: float) -> dict[str, tuple[list[float], list[float]]]:
    """N and ms per step of every stepper at one dt."""
    found: dict[str, tuple[list[float], list[float]]] = {}
    for row in rows:
        if row["dt (s)"] == dt:
            count, cost = found.setdefault(str(row["stepper"]), ([], []))
            count.append(float(row["N"] or 0))
            cost.append(float(row["ms/step"] or 0.0))
    return found


def _slopes(rows: list[Row]) -> list[Row]:
    found: list[Row] = []
    for dt in STEPS:
        for name, (count, cost) in _series(rows, dt).items():
            large = [i for i, n in enumerate(count) if n >= 1000]
            if len(large) > 2:
                exponent = slope(np.array(count)[large], np.array(cost)[large])
                found.append({"stepper": name, "dt (s)": dt, "slope": exponent})
    return found


def _picture(rows: list[Row]) -> Figure:
    figure = render.figure(10.0, 4.5)
    for ax, dt in zip(figure.subplots(1, len(STEPS), sharey=True), STEPS, strict=True):
        for name, (count, cost) in _series(rows, dt).items():
            style = {"linestyle": "--", "color": "#777777"} if name.startswith("native") else {}
            ax.loglog(count, cost, "o", linestyle=style.get("linestyle", "-"), color=style.get("color"), label=name)
        ax.set(xlabel="disks", ylabel="ms per step", title=f"dt = {dt:g} s")
        ax.legend(fontsize=7)
    figure.suptitle("Elastic gas, packing .3: cost of a step")
    return figure
