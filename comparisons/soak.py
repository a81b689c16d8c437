"""Soak: a million steps of a gas, linkages, ten minutes of the hopper; who is inside. Takes --workers, --only."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence

import numpy as np
from tqdm import tqdm

import eeca_pymunk as ep
import scenes
from comparisons import pool
from comparisons.hard_cases.joints import apart
from comparisons.hopper import crossed
from comparisons.output import Output, Row
from scenes import linkages

STEPS, DT, RADIUS = 1_000_000, 1e-3, 0.03
LOOKS = 10
MINUTES = 10.0
TURNS = 10_000
SWINGS = 100_000
MIXED = {f"mixed, {'bowl' if bowl else 'box'}, {seed}": (seed, bowl) for bowl in (False, True) for seed in (0, 1)}
JOINTED = {
    "pendulum": linkages.pendulum, "double pendulum": linkages.bars, "four-bar": linkages.braced_four_bar,
}  # fmt: skip


CHOICES = dict.fromkeys(("gas", "mixed", "joints", "hopper"))


def run(output: Output, full: bool, workers: int = 1, only: Sequence[str] = ()) -> None:
    """Print the tables, or only some; write CSV."""
    output.parameters({"steps": STEPS, "dt": DT, "radius": RADIUS})
    kinds: dict[str, tuple[str, list[tuple[str, float]]]] = {
        "gas": (f"Gas, 20 disks, {STEPS} steps of EECA TimeOfImpact", [("gas", STEPS)]),
        "mixed": (f"Mixed shapes that turn, {TURNS} steps", [(name, TURNS) for name in MIXED]),
        "joints": (f"Joints, {SWINGS} steps of 1/60 s", [(name, SWINGS) for name in JOINTED]),
        "hopper": (f"Hopper, {MINUTES:g} minutes of EECA TimeOfImpact", [("hopper", MINUTES)]),
    }
    chosen = only or list(CHOICES)
    found = iter(pool.over(part, [case for name in chosen for case in kinds[name][1]], workers))
    for name in chosen:
        title, cases = kinds[name]
        output.table(title, [row for _ in cases for row in next(found)], "" if name == "gas" else name)


def part(case: tuple[str, float]) -> list[Row]:
    """The rows of a case: its name, and its steps, or minutes of the hopper."""
    name, length = case
    if name == "gas":
        return soak(int(length))
    if name == "hopper":
        return hopper(60.0 * length)
    return [mixed(int(length), *MIXED[name]) if name in MIXED else linkage(int(length), name)]


def soak(steps: int, looks: int = LOOKS) -> list[Row]:
    """Rows of measures, `looks` of them over so many steps."""
    scene = scenes.build("gas", count=20, radius=RADIUS, seed=1)
    stepper, start = ep.EECA(scene.space), ep.measure(scene.space).energy
    rows: list[Row] = []
    drift, impacts = 0.0, 0
    for k in tqdm(range(1, steps + 1), desc="soak", unit="step", mininterval=1.0, disable=None):
        impacts += len(stepper.step(DT).contacts)
        if k % max(1, steps // looks) == 0:
            drift = max(drift, abs(ep.measure(scene.space).energy / start - 1.0))
            x = np.array([b.position for b in scene.bodies])
            outside = ((x < RADIUS - 1e-9) | (x > 1.0 - RADIUS + 1e-9)).any(axis=1)
            apart = np.linalg.norm(x[:, None] - x[None], axis=2) + 9.0 * np.eye(len(x))
            rows.append({
                "steps": k, "impacts": impacts, "max |dE/E|": drift, "outside": int(outside.sum()),
                "deepest overlap (r)": max(0.0, 2.0 - float(apart.min()) / RADIUS), "memory (MB)": memory(),
            })  # fmt: skip
    return rows


def mixed(steps: int, seed: int, bowl: bool) -> Row:
    """Measures of 20 boxes, capsules, compound bodies and disks in a box, or in a bowl under gravity."""
    scene = scenes.build("mixed", seed=seed, bowl=bowl)
    stepper, start = ep.EECA(scene.space, sync=False), ep.measure(scene.space).energy
    drift, impacts = 0.0, 0
    for _ in tqdm(range(steps), desc="mixed", unit="step", mininterval=1.0, disable=None):
        impacts += len(stepper.step(scene.dt).contacts)
        drift = max(drift, abs(ep.measure(scene.space).energy / start - 1.0))
    x = np.array([b.position for b in scene.bodies])
    low, high = (np.array((-4.0, -4.0)), np.array((8.0, 16.0))) if bowl else (np.zeros(2), np.full(2, 4.0))
    outside = int(((x < low) | (x > high)).any(axis=1).sum())
    return {"in": "bowl" if bowl else "box", "seed": seed, "impacts": impacts, "max |dE/E|": drift, "outside": outside}


def linkage(steps: int, name: str) -> Row:
    """Of one of JOINTED: drift of the energy, by how far joints come apart."""
    row: dict[str, str | float] = {"scene": name}
    for stepper in ("EECA", "native"):
        space = JOINTED[name]()
        step = ep.EECA(space).step if stepper == "EECA" else space.step
        scale = sum(body.mass for body in space.bodies) * linkages.GRAVITY
        start, drift, gap = ep.measure(space).energy, 0.0, 0.0
        for k in tqdm(range(1, steps + 1), desc=f"{name}, {stepper}", unit="step", mininterval=1.0, disable=None):
            step(1 / 60)
            if k % 20 == 0:
                drift, gap = max(drift, abs(ep.measure(space).energy - start)), max(gap, apart(space))
        row |= {f"{stepper}: |dE|/mgl": drift / scale, f"{stepper}: joints apart (m)": gap}
    return row


def hopper(seconds: float, looks: int = LOOKS) -> list[Row]:
    """Rows of measures, `looks` of them over so many seconds of the clock on the wall."""
    scene = scenes.build("hopper", dt=5e-4)
    stepper, start = ep.EECA(scene.space), ep.measure(scene.space).energy
    rows: list[Row] = []
    leaked: set[int] = set()
    drift, steps, begun = 0.0, 0, time.perf_counter()
    x = np.array([b.position for b in scene.bodies])
    with tqdm(total=looks, desc="hopper", unit="look", disable=None) as bar:
        while len(rows) < looks:
            stepper.step(scene.dt)
            steps += 1
            before, x = x, np.array([b.position for b in scene.bodies])
            leaked |= set(np.flatnonzero(crossed(before, x)).tolist())
            if time.perf_counter() - begun < seconds * (len(rows) + 1) / looks:
                continue
            drift = max(drift, abs(ep.measure(scene.space).energy / start - 1.0))
            rows.append({
                "steps": steps, "time (s)": steps * scene.dt, "max |dE/E|": drift, "leaked": len(leaked),
                "memory (MB)": memory(),
            })  # fmt: skip
            bar.update()
    return rows


def memory() -> float | None:
    """Largest memory the process has held so far, MB; None where the system does not tell."""
    if sys.platform == "win32":
        return None
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1024.0**2 if sys.platform == "darwin" else 1024.0)
