"""Other engines: errors, energies, costs of five scenes, and of large ones. Needs EECA_ENGINES, a folder with them.

Engines are other people's and large, so that they are kept out of this package's environment:

    python -m venv engines/venv && engines/venv/bin/pip install Box2D pyb2d3 mujoco dartpy
    cd engines && npm install planck matter-js
    EECA_ENGINES=engines python -m comparisons engines

Box2D is the package of 2.3 (pybox2d), Box2D v3 that of `pyb2d3`; hundreds of bodies are compared with the latter
(`large.py`).

What is not there is skipped with a word. Each engine runs in a process of its own (`drivers/`), which gets a scene as
JSON and gives states and the time of all steps. Settings are those the engines ship with, but for what a scene needs:
no damping, elasticity, friction, and MuJoCo's contact stiffness, which stands in its driver.
"""

from __future__ import annotations

import json
import os
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pymunk
from tqdm import tqdm

import eeca_pymunk as ep
from comparisons import steps
from comparisons.engines import described, large, problems
from comparisons.engines.problems import Problem
from comparisons.output import Output, Row

FloatArray = npt.NDArray[np.float64]
DRIVERS = Path(__file__).parent / "drivers"
LOOKS = 50  # at the energy of a run
ENOUGH = 0.3  # s of runs that are short
FINER = 10  # the second dt of each scene is so many times smaller
LIMIT = 300  # s for a run
# No engine here brings shapes up to date for queries.
OURS: dict[str, Callable[[pymunk.Space], steps.Step]] = {
    **steps.STEPS, "EECA": lambda space: ep.EECA(space, sync=False).step,
}  # fmt: skip
OTHERS = {
    "Box2D": "box_2d.py", "Box2D v3": "box2d_3.py", "MuJoCo": "mujoco_.py", "DART": "dart_.py",
    "planck": "planck_.js", "matter-js": "matter.js",
}  # fmt: skip


@dataclass(frozen=True)
class Ended:
    """(T, N, 6) x, y, angle and their rates at the looks, the last at the end; seconds of the process in all steps."""

    states: FloatArray
    seconds: float


def ours(name: str, problem: Problem, dt: float, steps: int, every: int) -> Ended:
    """A run of this package or of pymunk, the quickest of some where it is short."""
    ended = [_once(name, problem, dt, steps, every)]
    while sum(one.seconds for one in ended) < ENOUGH and len(ended) < 9:
        ended.append(_once(name, problem, dt, steps, every))
    return Ended(ended[0].states, min(one.seconds for one in ended))


def _once(name: str, problem: Problem, dt: float, steps: int, every: int) -> Ended:
    space, bodies = problem.space()
    step, seconds, states = OURS[name](space), 0.0, []
    for k in range(0, steps, every):
        begun = time.process_time()
        for _ in range(min(every, steps - k)):
            step(dt)
        seconds += time.process_time() - begun
        states.append([(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in bodies])
    return Ended(np.array(states), seconds)


def other(name: str, folder: Path, problem: Problem, dt: float, steps: int, every: int) -> Ended | str:
    """A run of another engine; or why there is none."""
    job = {"dt": dt, "steps": steps, "every": every, "enough": ENOUGH}
    if name == "Box2D v3":
        space, bodies = problem.space()
        job |= {**described.space(space, bodies), "count": len(bodies)}
    else:
        job |= problem.described()
    answer = asked(name, folder, job)
    if isinstance(answer, str):
        return answer
    return Ended(np.array(answer["states"], dtype=float), float(answer["seconds"]))


def films(job: dict[str, Any], each: list[dict[str, Any]]) -> list[Ended] | str:
    """Runs of one scene under Box2D, each with what is its own; or why there are none."""
    answer = asked("Box2D", Path(os.environ.get("EECA_ENGINES", "engines")), {**job, "films": each})
    if isinstance(answer, str):
        return answer
    return [Ended(np.array(one["states"], dtype=float), float(one["seconds"])) for one in answer]


def asked(name: str, folder: Path, job: dict[str, Any]) -> Any:
    """The answer of another engine, in a process of its own; or as a string why there is none."""
    driver = DRIVERS / OTHERS[name]
    environment = dict(os.environ)
    if driver.suffix == ".js":
        command = ["node", str(driver)]
        environment["NODE_PATH"] = str((folder / "node_modules").resolve())
    else:
        python = folder / "venv" / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
        command = [str(python.absolute()), str(driver)]
    try:
        done = subprocess.run(
            command, input=json.dumps(job), env=environment, capture_output=True, text=True, timeout=LIMIT
        )
    except FileNotFoundError:
        return f"no {command[0]}"
    except subprocess.TimeoutExpired:
        return f"more than {LIMIT} s"
    if done.returncode != 0:
        return (done.stderr.strip().splitlines() or ["failed"])[-1][:80]
    return json.loads(done.stdout.splitlines()[-1])


def row(problem: Problem, name: str, dt: float, steps: int, ended: Ended) -> Row:
    """What the table tells of a run."""
    last = ended.states[-1]
    exact = problem.exact(steps * dt)
    error = None if exact is None else float(np.linalg.norm(last[:, :2] - exact, axis=1).max()) / problem.size
    energy = np.array([problem.energy(state) for state in ended.states])
    every = -(-steps // len(ended.states))
    times = [min((k + 1) * every, steps) * dt for k in range(len(ended.states))]
    wanted = np.array([problem.energy_change(t) for t in times])
    off = float(np.abs(energy - problem.energy(problem.start) - wanted).max()) / problem.scale
    finite = bool(np.isfinite(ended.states).all())
    return {
        "scene": problem.name, "engine": name, "dt (s)": dt, "error (sizes)": error if finite else float("inf"),
        "energy error": off if finite else float("inf"), "us/step": 1e6 * ended.seconds / steps,
        "x pymunk": None,
    }  # fmt: skip


def listed() -> list[Problem]:
    """The scenes."""
    return problems.problems()


def run(output: Output, full: bool) -> None:
    """Print the table; write CSV."""
    folder = Path(os.environ.get("EECA_ENGINES", "engines"))
    print(f"# other engines from {folder} (EECA_ENGINES); lengths in sizes of a body, energies by that of the scene")
    ep.warmup()
    skipped: dict[str, str] = {}
    rows: list[Row] = []
    jobs = [(p, dt, name) for p in listed() for dt in (p.dt, p.dt / FINER) for name in (*OURS, *OTHERS)]
    for problem, dt, name in tqdm(jobs, desc="engines", unit="run", disable=None):
        steps = round(problem.duration / dt)
        every = max(1, steps // LOOKS)
        if name in OURS:
            ours(name, problem, dt, 3, 3)
            found: Ended | str = ours(name, problem, dt, steps, every)
        else:
            found = skipped[name] if name in skipped else other(name, folder, problem, dt, steps, every)
        if isinstance(found, str):
            skipped.setdefault(name, found)
        else:
            rows.append(row(problem, name, dt, steps, found))
    native = {(r["scene"], r["dt (s)"]): float(r["us/step"] or 0.0) for r in rows if r["engine"] == "pymunk"}
    rows = [{**r, "x pymunk": float(r["us/step"] or 0.0) / native[r["scene"], r["dt (s)"]]} for r in rows]
    output.table("Errors of places at the end, largest errors of the energy, time of a step", rows)
    scenes = tqdm(large.listed(), desc="large scenes", unit="scene", disable=None)
    rows = [one for scene in scenes for one in large.rows(lambda job: asked("Box2D v3", folder, job), scene)]
    output.table("Hundreds of bodies: time of a step, and what each engine breaks", rows, "large")
    for name, why in skipped.items():
        print(f"skipped {name}: {why}")
