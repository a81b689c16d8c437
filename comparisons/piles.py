"""Piles: disks and boxes that fall, settle and rest: cost against pymunk in one interleaved run, and how they rest.

Cost is time of this process, step by step in turn, so that whatever slows the machine down slows all of them down.
Depths are measured by pymunk's own narrow phase for everybody. A resting pile should neither sink nor creep; how many
bodies still move at the end says which piles rest (boxes without friction slide on for minutes).
"""

from __future__ import annotations

import functools
import math
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pymunk
from tqdm import tqdm

import eeca_pymunk as ep
from comparisons import pile_picture, pile_precision
from comparisons.output import Output, Row
from comparisons.scaling import HASH_FROM

G, R = 9.81, 0.5  # m/s²; m, radius of disks and of circles inscribed in boxes
KINDS = ("disks", "boxes", "mixed")
COUNTS = (30, 100, 300, 1000)
ELASTICITIES = (0.0, 0.3, 0.5)
FRICTIONS = (0.0, 0.5)
DT = 1 / 60  # s
FALLING, STEPS, SETTLED = 300, 800, 50  # steps of falling and settling, of a run, at its end
RESTS = 1e-3  # radii, which bodies of a pile that rests may creep in SETTLED steps: no more than this
ITERATIONS = (10, 100)  # of pymunk: as shipped, and more
LOOK = 10  # steps between looks at depths
EECA = "EECA"


def pile(kind: str, count: int, elasticity: float, friction: float, seed: int = 0) -> pymunk.Space:
    """`count` disks or boxes of mass 1, or both in turn, above a floor between two walls, at heights up to count^(1/2)
    diameters. The elasticity and friction of a contact are those given."""
    rng = np.random.default_rng(seed)
    space, side = pymunk.Space(), math.ceil(math.sqrt(count))
    space.gravity = (0.0, -G)
    shape: pymunk.Shape
    for i in range(count):
        body = pymunk.Body(1.0, 1.0)
        body.position = (1.5 * (i % side) + 0.2 * rng.random(), 0.8 + 1.5 * (i // side))
        if kind == "disks" or (kind == "mixed" and i % 2):
            body.moment = pymunk.moment_for_circle(1.0, 0.0, R)
            shape = pymunk.Circle(body, R)
        else:
            body.moment, body.angle = pymunk.moment_for_box(1.0, (2 * R, 2 * R)), float(rng.random())
            shape = pymunk.Poly.create_box(body, (2 * R, 2 * R))
        _set(shape, elasticity, friction)
        space.add(body, shape)
    left, right, top = -1.0, 1.5 * side, 3.0 * side
    for a, b in (((left, 0.0), (right, 0.0)), ((left, 0.0), (left, top)), ((right, 0.0), (right, top))):
        shape = pymunk.Segment(space.static_body, a, b, 0.0)
        _set(shape, elasticity, friction)
        space.add(shape)
    if count >= HASH_FROM:
        space.use_spatial_hash(3.0 * R, 2 * count)
    return space


def _set(shape: pymunk.Shape, elasticity: float, friction: float) -> None:
    # pymunk takes the product of the two shapes.
    shape.elasticity, shape.friction = math.sqrt(elasticity), math.sqrt(friction)


def deepest(space: pymunk.Space) -> float:
    """Depth of the deepest contact, in radii, by pymunk's narrow phase; 0 without an overlap."""
    for body in space.bodies:
        space.reindex_shapes_for_body(body)
    found = 0.0
    for body in space.bodies:
        for shape in body.shapes:
            for info in space.shape_query(shape):
                found = min(found, min((p.distance for p in info.contact_point_set.points), default=0.0))
    return -found / R


@dataclass
class Track:
    """One stepper on a pile of its own, and what was seen of it so far."""

    name: str
    space: pymunk.Space
    step: Callable[[float], ep.StepReport | None]
    seconds: list[float] = field(default_factory=list)
    depth: float = 0.0
    rise: float = 0.0
    residual: float = 0.0
    unmet: int = 0  # steps that met not all tolerances

    def __post_init__(self) -> None:
        self.bodies = self.space.bodies
        now = ep.measure(self.space)
        # Of the fall: what a pile can lose at most.
        self.energy, self.scale = now.energy, now.energy
        self.places = [self.place()]

    def place(self) -> np.ndarray:
        """(n, 2) positions."""
        return np.array([b.position for b in self.bodies])

    def advance(self, dt: float, look: bool) -> None:
        """A step on the clock, and what it did off the clock."""
        begin = time.process_time()
        report = self.step(dt)
        self.seconds.append(time.process_time() - begin)
        energy = ep.measure(self.space).energy
        self.rise, self.energy = max(self.rise, (energy - self.energy) / self.scale), energy
        if report is not None:
            self.unmet += not report.converged
            if report.ledger is not None:
                self.residual = max(self.residual, abs(report.ledger.residual) / self.scale)
        if look:
            self.depth = max(self.depth, deepest(self.space))


def tracks(kind: str, count: int, elasticity: float, friction: float) -> list[Track]:
    """EECA, and pymunk with each number of iterations, on equal piles."""
    found = []
    for iterations in ITERATIONS:
        space = pile(kind, count, elasticity, friction)
        space.iterations = iterations
        found.append(Track(f"native {iterations}", space, space.step))
    space = pile(kind, count, elasticity, friction)
    return [*found, Track(EECA, space, ep.EECA(space, sync=False).step)]


@functools.cache
def warm() -> None:
    """Falls of crowds, so that all kernels are there."""
    for kind in KINDS:
        for elasticity, friction in ((0.0, 0.0), (0.3, 0.5)):
            stepper = ep.EECA(pile(kind, 60, elasticity, friction), sync=False)
            for _ in range(200):
                stepper.step(DT)


def case(
    kind: str, count: int, elasticity: float, friction: float, steps: int = STEPS, falling: int = FALLING,
    settled: int = SETTLED,
) -> list[Row]:  # fmt: skip
    """All steppers on one pile, a row for each."""
    runs = tracks(kind, count, elasticity, friction)
    # Compiled, and read from the disk, before the clock runs.
    warm()
    for k in tqdm(range(steps), desc=f"{count} {kind}", leave=False, disable=None):
        for run in runs:
            if k == steps - settled:
                run.places.append(run.place())
            run.advance(DT, k % LOOK == 0 or k == steps - 1)
    rows: list[Row] = []
    base = {run.name: run for run in runs}[f"native {ITERATIONS[0]}"]
    more = {run.name: run for run in runs}[f"native {ITERATIONS[-1]}"]
    mean, slow = (statistics.mean(run.seconds[:falling]) for run in (base, more))
    late = statistics.mean(base.seconds[-settled:])
    for run in runs:
        spent = statistics.mean(run.seconds[:falling])
        crept = np.hypot(*(run.place() - run.places[-1]).T) / R
        rows.append({
            "kind": kind, "N": count, "e": elasticity, "mu": friction, "stepper": run.name,
            "us/step": 1e6 * spent, f"x native {ITERATIONS[0]}": spent / mean,
            f"x native {ITERATIONS[-1]}": spent / slow,
            "worst step (native means)": max(run.seconds) / mean,
            "whole run, x native": sum(run.seconds) / sum(base.seconds),
            "at the end, x native": statistics.mean(run.seconds[-settled:]) / late,
            "deepest (r)": run.depth,
            "largest creep (r)": float(crept.max()), "median creep (r)": float(np.median(crept)),
            "still moving": int((crept > RESTS).sum()),
            "energy rise": run.rise, "ledger residual": run.residual if run.name == EECA else None,
            "steps not met": run.unmet,
        })  # fmt: skip
    return rows


def summary(rows: list[Row]) -> list[Row]:
    """Largest figures of EECA over elasticity and friction, and native's beside."""
    found: list[Row] = []
    for kind in KINDS:
        for count in COUNTS:
            mine = [r for r in rows if r["kind"] == kind and r["N"] == count]
            if not mine:
                continue
            ours = [r for r in mine if r["stepper"] == EECA]
            theirs = [r for r in mine if r["stepper"] == f"native {ITERATIONS[0]}"]
            row: dict[str, str | int | float | bool | None] = {"kind": kind, "N": count}
            ratios = [f"x native {most}" for most in ITERATIONS]
            for name in (*ratios, "whole run, x native", "worst step (native means)"):
                row[name] = max(_number(r[name]) for r in ours)
            moving = [r for r in ours if _number(r["still moving"]) > 0]
            resting = [r for r in ours if r not in moving]
            for name, some in (("at rest", resting), ("still moving", moving)):
                row[f"piles {name}"] = len(some)
                row[f"{name}, x native"] = max((_number(r["at the end, x native"]) for r in some), default=None)
            for name in ("deepest (r)", "largest creep (r)", "energy rise"):
                row[name] = max(_number(r[name]) for r in ours)
                row[f"native's {name}"] = max(_number(r[name]) for r in theirs)
            row["ledger residual"] = max(_number(r["ledger residual"]) for r in ours)
            found.append(row)
    return found


def _number(value: object) -> float:
    return float(value) if isinstance(value, int | float) else 0.0


def quick() -> list[Row]:
    """A few small piles over a few steps: that everything works, not what it costs."""
    return [row for kind in KINDS for row in case(kind, 6, 0.3, 0.5, steps=30, falling=20, settled=10)]


def run(output: Output, full: bool) -> None:
    """Print the tables; write CSV and pictures."""
    output.parameters({"dt": DT, "N": COUNTS, "e": ELASTICITIES, "mu": FRICTIONS, "steps": STEPS, "settled": SETTLED})
    cases = [(k, n, e, mu) for n in COUNTS for k in KINDS for e in ELASTICITIES for mu in FRICTIONS]
    rows: list[Row] = []
    for one in tqdm(cases, desc="piles", unit="pile", disable=None):
        rows += case(*one)
    output.table("Piles that fall and settle, all steppers in one interleaved run", rows, "all")
    output.table("The largest over elasticity and friction", summary(rows))
    output.picture(pile_picture.draw(rows))
    pile_precision.run(output)
