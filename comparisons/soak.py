"""Soak: one million steps of a gas of 20 disks; drift of energy, who is inside, and memory on the way."""

from __future__ import annotations

import sys

import numpy as np
from tqdm import tqdm

import eeca_pymunk as ep
import scenes
from comparisons.output import Output, Row

STEPS, DT, RADIUS = 1_000_000, 1e-3, 0.03
LOOKS = 10


def run(output: Output, full: bool) -> None:
    """Print the table; write CSV."""
    output.parameters({"steps": STEPS, "dt": DT, "radius": RADIUS})
    output.table(f"Gas, 20 disks, {STEPS} steps of EECA TimeOfImpact", soak(STEPS))


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


def memory() -> float | None:
    """Largest memory the process has held so far, MB; None where the system does not tell."""
    if sys.platform == "win32":
        return None
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1024.0**2 if sys.platform == "darwin" else 1024.0)
