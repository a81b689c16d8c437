"""Every heuristic switched off, one at a time: what it is worth on piles whose layouts vary, hard cases, random scenes.

Each variant is a copy of the package in which one parameter (`eeca_pymunk.model.parameters`) has a value that takes the
rule away; its library is built anew, in a process of its own. Costs are times of the process over pymunk's in the same
process, so that the machine's speed cancels; 1 is the package as it is.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tqdm import tqdm

import eeca_pymunk as ep
import scenes.layouts as layouts
from comparisons.hard_cases.case import CASES
from comparisons.hard_cases.matrix import columns, figure
from comparisons.output import Output, Row
from comparisons.piles import deepest
from eeca_pymunk.model.parameters import table

ROOT = Path(__file__).parents[1]
DT, STEPS, REST, COUNT = 1 / 60, 300, 20, 60  # s; steps of a pile, at its end, bodies
LONGEST = 300  # s that a variant may take for each seed; the package takes a tenth of it
SMOOTH = 1e-3  # radii in REST steps, that a body at rest may move
NEVER, ALWAYS = "1 << 40", "1e300"  # of counts; of lengths and speeds
# What takes each rule away: a value that it never, or always, reaches.
OFF = {
    "SLENDER": "0.0", "BLOCK_BODIES": "1 << 20", "EXACT_CONTACTS": "0", "INTERVAL_WAY": ALWAYS,
    "INTERVAL_DEPTH": ALWAYS, "INTERVAL_DEPTH_WIDTH": ALWAYS, "INTERVAL_DEPTH_LEAST": "0.0", "INTERVAL_RETRY": ALWAYS,
    "LARGE_ISLAND": "1 << 20", "REST_CANDIDATE": "0.0", "REST_CANDIDATE_LARGE": "0.0", "STOPPING_STEPS": "1.0",
    "ROCKING": "0.0", "INITIAL_PENETRATION": ALWAYS, "SOLVES_BEFORE_HASTE": NEVER, "MOVING_SHARE": "0.0",
    "JOINT_SPEED_LEFT": "0.0", "TAKEN_OVER_LEFT": "0.0", "TAUT": ALWAYS, "WEDGED": ALWAYS, "SLIGHT_DEPTH": ALWAYS,
    "LIMIT_HOP": "-1.0", "FLUSH": "-1.0", "SAME_SIDE": "2.0",
}  # fmt: skip


def pile(layout: str, kind: str, seed: int, count: int = COUNT, steps: int = STEPS) -> dict[str, float]:
    """One pile under both steppers, step by step in turn."""
    space, native = (layouts.build(layout, kind, count, seed=seed) for _ in range(2))
    stepper = ep.EECA(space, sync=False)
    scale = energy = ep.measure(space).energy
    spent, theirs, rise, depth, unmet, places = 0.0, 0.0, 0.0, 0.0, 0, []
    for k in range(steps):
        begun = time.process_time()
        report = stepper.step(DT)
        spent -= begun - time.process_time()
        begun = time.process_time()
        native.step(DT)
        theirs -= begun - time.process_time()
        now = ep.measure(space).energy
        rise, energy, unmet = max(rise, (now - energy) / scale), now, unmet + (not report.converged)
        if k % 20 == 0:
            depth = max(depth, deepest(space))
        if k == steps - REST - 1:
            places = [b.position for b in space.bodies]
    moves = sum((b.position - p).length > SMOOTH * layouts.RADIUS for b, p in zip(space.bodies, places, strict=True))
    return {"cost": spent / theirs, "unmet": unmet / steps, "depth": depth, "rise": rise, "moving": moves / count}


def measure(seeds: int) -> dict[str, float]:
    """All piles, hard cases and random scenes of this process's package."""
    ep.warmup()
    piles = [pile(la, k, s) for la in layouts.LAYOUTS for k in layouts.KINDS for s in range(seeds)]
    found = {
        "cost": statistics.geometric_mean([p["cost"] for p in piles]),
        "unmet": statistics.mean(p["unmet"] for p in piles),
        "depth": statistics.mean(p["depth"] for p in piles),
        "rise": max(p["rise"] for p in piles),
        "moving": statistics.mean(p["moving"] for p in piles),
    }
    make = columns()["TimeOfImpact"]
    failed = []
    for one in CASES:
        value = figure(one, make)
        if value is None or not value <= one.limit:
            failed.append(one.name)
    return {**found, "hard cases failed": len(failed), "which": "; ".join(failed)}  # type: ignore[dict-item]


def switched(name: str, value: str, copy: Path) -> None:
    """Give a parameter of the package in the folder `copy` another value."""
    for path in (copy / "eeca_pymunk" / "model" / "parameters").glob("*.py"):
        text = path.read_text()
        new = re.sub(rf"^({name} = heuristic\(\s*)[^,]+,", rf"\g<1>{value},", text, flags=re.MULTILINE)
        if new != text:
            path.write_text(new)
            return
    raise ValueError(f"{name} is no heuristic")


@contextmanager
def package_without(name: str, *rooms: str) -> Iterator[tuple[str, dict[str, str]]]:
    """A copy of the package, and of these rooms beside it, with one rule off, all on if the name is empty: its folder,
    and an environment that runs it."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)
        for room in ("eeca_pymunk", *rooms):
            shutil.copytree(ROOT / room, copy / room, ignore=shutil.ignore_patterns("__pycache__", "figures"))
        if name:
            switched(name, OFF[name], copy)
        environment = {**os.environ, "PYTHONPATH": folder, "EECA_KERNELS": "library"}
        subprocess.run(
            [sys.executable, "-m", "eeca_pymunk.build"], cwd=folder, env=environment, check=True, capture_output=True
        )
        yield folder, environment


def variant(name: str, seeds: int) -> dict[str, float]:
    """What is measured with one rule off; with an empty name, of the package as it is."""
    with package_without(name, "scenes", "comparisons") as (folder, environment):
        try:
            done = subprocess.run(
                [sys.executable, "-m", "comparisons.ablation", str(seeds)], cwd=folder, env=environment,
                capture_output=True, text=True, timeout=LONGEST * seeds,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return {"which": f"not done after {LONGEST * seeds} s"}  # type: ignore[dict-item]
        if done.returncode:
            return {"which": done.stderr.strip().splitlines()[-1][:100]}  # type: ignore[dict-item]
        return dict(json.loads(done.stdout.splitlines()[-1]))


def run(output: Output, full: bool, names: tuple[str, ...] = ()) -> None:
    """Print the table; write CSV. `full`: three seeds of each layout instead of one."""
    seeds = 3 if full else 1
    heuristics = [n for found in table().values() for n, p in found.items() if p.kind == "heuristic" and n in OFF]
    output.parameters({"layouts": layouts.LAYOUTS, "kinds": layouts.KINDS, "bodies": COUNT, "seeds": seeds, "dt": DT})
    base = variant("", seeds)
    rows: list[Row] = []
    for name in tqdm(["", *(names or heuristics)], desc="ablation", disable=None):
        found = variant(name, seeds) if name else base
        rows.append({
            "off": name or "nothing", "cost": found.get("cost", float("nan")) / base["cost"],
            **{k: found.get(k) for k in ("unmet", "depth", "rise", "moving", "hard cases failed", "which")},
        })  # fmt: skip
        output.csv(rows)
    output.table(
        "Cost relative to the package; share of steps not converged; deepest overlap (radii); rise of energy", rows
    )


if __name__ == "__main__":
    print(json.dumps(measure(int(sys.argv[1]))))
