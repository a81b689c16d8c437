"""Scaling: whole steps against `space.step` for 1 to 64 000 disks, turning shapes and the hopper; first use."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np
import pymunk
from matplotlib.figure import Figure
from tqdm import tqdm

import eeca_pymunk as ep
import scenes
from comparisons.output import Output, Row
from comparisons.runs import slope
from eeca_pymunk import render
from scenes import Scene

COUNTS = (1, 10, 100, 1000, 4000, 16_000, 64_000)
STEPS, PACKING = (2e-4, 1e-3), 0.3  # s; part of the area that disks cover
HASH_FROM = 50  # bodies from which native has its spatial hash
MIDSTEP_TO = 1000  # disks up to which a step of a simultaneous closure is worth waiting for
HOPPER_DT, HOPPER_DURATION = 5e-4, 1.0
WARM = 10  # steps before the clock runs: lists are made, caches are filled
BLOCK = 4e-3  # s of work that a block of steps takes, if not the least
ROUNDS, LEAST = 15, 2  # rounds over all steppers; steps of a block, at least
FAR = (1e3, 1e3)  # m, beside the gas
COUNTED = 4000  # collisions that are counted for the cost of one, at most 1000 steps


@dataclass
class Runner:
    """One way of stepping one scene, with the seconds per step of each block so far (of this process, not the wall:
    other programs do not count)."""

    step: Callable[[float], object]
    block: int = LEAST
    seconds: list[float] = field(default_factory=list)

    def run(self, dt: float, steps: int) -> float:
        """Seconds that so many steps take."""
        step, begin = self.step, time.process_time()
        for _ in range(steps):
            step(dt)
        return time.process_time() - begin

    @property
    def median(self) -> float:
        """Seconds per step."""
        return statistics.median(self.seconds)


def native(scene: Scene, hashed: bool) -> Runner:
    """`space.step` itself, with or without a spatial hash."""
    if hashed:
        sizes = [s.radius for s in scene.space.shapes if isinstance(s, pymunk.Circle)]
        scene.space.use_spatial_hash(3.0 * min(sizes), 2 * len(scene.bodies))
    return Runner(scene.space.step)


def eeca(scene: Scene, closure: ep.Closure, sync: bool, hashed: bool, queried: bool = False) -> Runner:
    """EECA on a space like native's: with `sync` its broad phase is kept up too, when it is read; if `queried`, after
    each step."""
    if hashed:
        native(scene, True)
    space, step, everything = scene.space, ep.EECA(scene.space, closure, sync=sync).step, pymunk.ShapeFilter()

    def step_and_query(dt: float) -> None:
        step(dt)
        space.point_query_nearest(FAR, 0.0, everything)

    return Runner(step_and_query if queried else step)


def runners(build: Callable[[], Scene], hashed: bool, midstep: bool) -> dict[str, Runner]:
    """Native first; every stepper on a scene of its own."""
    found = {
        "native": native(build(), hashed),
        "EECA": eeca(build(), ep.TimeOfImpact(), False, hashed),
        "EECA, sync": eeca(build(), ep.TimeOfImpact(), True, hashed),
        "EECA, queried": eeca(build(), ep.TimeOfImpact(), True, hashed, queried=True),
    }
    if midstep:
        found["EECA Midstep"] = eeca(build(), ep.Midstep(), False, hashed)
    return found


def interleave(steppers: dict[str, Runner], dt: float, warm: int, rounds: int) -> None:
    """Blocks of steps in turn, so that whatever slows the machine down slows all of them down."""
    for runner in steppers.values():
        runner.run(dt, warm)
        runner.block = max(LEAST, min(2000, int(BLOCK / max(runner.run(dt, LEAST) / LEAST, 1e-7))))
    for _ in range(rounds):
        for runner in steppers.values():
            runner.seconds.append(runner.run(dt, runner.block) / runner.block)


def collisions_of_a_step(build: Callable[[], Scene], dt: float, warm: int) -> float:
    """Mean number of impulses in a step, after `warm` of them: at first nobody is near another, and there are few."""
    stepper, count, steps = ep.EECA(build().space, sync=False), 0, 0
    for _ in range(warm + LEAST):
        stepper.step(dt)
    while steps < 1000 and (count < COUNTED or steps < ROUNDS):
        count += len(stepper.step(dt).contacts)
        steps += 1
    return count / steps


def case(
    build: Callable[[], Scene], count: int, dt: float, warm: int = WARM, rounds: int = ROUNDS, midstep: bool = False
) -> list[Row]:  # fmt: skip
    """All steppers on one scene, in one run."""
    hashed = count >= HASH_FROM
    steppers = runners(build, hashed, midstep)
    interleave(steppers, dt, warm, rounds)
    collisions = collisions_of_a_step(build, dt, warm)
    base = steppers["native"]
    return [
        {
            "N": count, "dt (s)": dt, "stepper": name, "us/step": 1e6 * runner.median,
            # Of blocks that were run one after the other.
            "x native": statistics.median(a / b for a, b in zip(runner.seconds, base.seconds, strict=True)),
            "collisions/step": collisions,
            "us/collision": 1e6 * runner.median / collisions if collisions and name.startswith("EECA") else None,
        }
        for name, runner in steppers.items()
    ]  # fmt: skip


def hopper(dt: float = HOPPER_DT, duration: float = HOPPER_DURATION, parts: int = 4) -> list[Row]:
    """The whole filling from its first step, EECA with sync beside native as it is shipped; parts of the way."""
    chunk = 25
    chunks = round(duration / dt / chunk)
    ours, theirs = eeca(scenes.build("hopper"), ep.TimeOfImpact(), True, False), native(scenes.build("hopper"), False)
    ours_took, theirs_took = np.zeros(chunks), np.zeros(chunks)
    for k in tqdm(range(chunks), desc="hopper", leave=False, disable=None):
        ours_took[k], theirs_took[k] = ours.run(dt, chunk), theirs.run(dt, chunk)
    rows: list[Row] = []
    for first, last in [*((p * chunks // parts, (p + 1) * chunks // parts) for p in range(parts)), (0, chunks)]:
        a, b = float(ours_took[first:last].sum()), float(theirs_took[first:last].sum())
        steps = chunk * (last - first)
        rows.append({
            "from (s)": first * chunk * dt, "to (s)": last * chunk * dt, "EECA, sync (us/step)": 1e6 * a / steps,
            "native (us/step)": 1e6 * b / steps, "x native": a / b,
        })  # fmt: skip
    return rows


def features(count: int = 1000, dt: float = max(STEPS), rounds: int = ROUNDS) -> list[Row]:
    """What a gas pays for what it has, and for what stands beside it: step by step in turn with the plain gas."""
    changes: dict[str, Callable[[Scene], None]] = {
        "elastic, smooth": _all,
        "elasticity .9": lambda scene: _all(scene, elasticity=math.sqrt(0.9)),
        "friction .5": lambda scene: _all(scene, friction=math.sqrt(0.5)),
        "a pendulum beside": _pendulum,
    }
    timed = {}
    for name, change in changes.items():
        scene = scenes.build("gas", count=count, packing=PACKING)
        change(scene)
        timed[name] = eeca(scene, ep.TimeOfImpact(), False, False)
    interleave(timed, dt, WARM, rounds)
    plain = timed["elastic, smooth"].seconds
    return [
        {
            "gas": name, "N": count, "dt (s)": dt, "us/step": 1e6 * one.median,
            "x plain": statistics.median(a / b for a, b in zip(one.seconds, plain, strict=True)),
        }
        for name, one in timed.items()
    ]  # fmt: skip


def _all(scene: Scene, **values: float) -> None:
    for shape in scene.space.shapes:
        for name, value in values.items():
            setattr(shape, name, value)


def _pendulum(scene: Scene) -> None:
    space, body = scene.space, pymunk.Body(1.0, 1.0)
    body.position, body.angular_velocity = FAR, 1.0
    space.add(body, pymunk.PivotJoint(space.static_body, body, FAR))


def run(output: Output, full: bool) -> None:
    """Print the tables; write CSV and a picture."""
    output.parameters({"N": COUNTS, "packing": PACKING, "dt": STEPS, "hopper dt": HOPPER_DT})
    rows: list[Row] = []
    for count in tqdm(COUNTS, desc="scaling", unit="N", disable=None):
        for dt in STEPS:
            build = partial(scenes.build, "gas", count=count, packing=PACKING)
            rounds = ROUNDS if count <= 4000 else 7
            rows += case(build, count, dt, rounds=rounds, midstep=full and count <= MIDSTEP_TO)
    output.table("Elastic gas in a box, cost at equal dt (native with a spatial hash from 50 bodies)", rows, "gas")
    output.table("Slope of the cost in N", slopes(rows), "slope")
    output.table("What a collision more costs: between the two dt", marginal(rows), "collision")
    mixed: list[Row] = []
    for dt in (1e-3, 1e-2):
        mixed += case(partial(scenes.build, "mixed", count=20, bowl=True), 20, dt, warm=round(0.5 / dt))
    output.table("20 turning shapes under gravity in a bowl", mixed, "mixed")
    output.table("Hopper of 665 disks from the first step, native as shipped", hopper(), "hopper")
    output.table("What a gas of 1000 disks pays for what it has", features(), "features")
    output.picture(_picture(rows))


def _series(rows: list[Row], dt: float) -> dict[str, tuple[list[float], list[float]]]:
    """N and us per step of every stepper at one dt."""
    found: dict[str, tuple[list[float], list[float]]] = {}
    for row in rows:
        if row["dt (s)"] == dt:
            count, cost = found.setdefault(str(row["stepper"]), ([], []))
            count.append(float(row["N"] or 0))
            cost.append(float(row["us/step"] or 0.0))
    return found


def slopes(rows: list[Row]) -> list[Row]:
    """Exponents of the cost in N, over all sizes, and over those of 1000 disks and more."""
    found: list[Row] = []
    for dt in STEPS:
        for name, (count, cost) in _series(rows, dt).items():
            large = [i for i, n in enumerate(count) if n >= 1000]
            if len(large) > 2:
                whole, part = (slope(np.array(count)[k], np.array(cost)[k]) for k in (slice(None), large))
                found.append({"stepper": name, "dt (s)": dt, "slope": part, "from 1 disk on": whole})
    return found


def marginal(rows: list[Row]) -> list[Row]:
    """(time at the long dt - time at the short one) / (collisions of the one - of the other), 1000 disks and more."""
    found: list[Row] = []
    short, long = ({(r["N"], r["stepper"]): r for r in rows if r["dt (s)"] == dt} for dt in (min(STEPS), max(STEPS)))
    for (count, name), row in long.items():
        other = short[count, name]
        more = float(row["collisions/step"] or 0.0) - float(other["collisions/step"] or 0.0)
        if float(count or 0) >= 1000 and str(name).startswith("EECA"):
            took = float(row["us/step"] or 0.0) - float(other["us/step"] or 0.0)
            found.append({"N": count, "stepper": name, "us/collision more": took / more})
    return found


def _picture(rows: list[Row]) -> Figure:
    figure = render.figure(10.0, 4.5)
    for ax, dt in zip(figure.subplots(1, len(STEPS), sharey=True), STEPS, strict=True):
        for name, (count, cost) in _series(rows, dt).items():
            style = {"linestyle": "--", "color": "#777777"} if name.startswith("native") else {}
            ax.loglog(count, cost, "o", linestyle=style.get("linestyle", "-"), color=style.get("color"), label=name)
        ax.set(xlabel="disks", ylabel="us per step", title=f"dt = {dt:g} s")
        ax.legend(fontsize=7)
    figure.suptitle("Elastic gas, packing .3: cost of a step")
    return figure
