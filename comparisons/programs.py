"""What real programs cost: pymunk's examples and scenes of public programs, step by step beside `Space.step`.

Each program runs as it is, with keys and mouse by script (`play`), in a process of its own: as it is and with
`Space.step` replaced by ours, default settings, five times in turn, and once with clocks around the parts of a step.
Of each step counts the least processor time, with that of moving shapes which the program reads after it; the first
one, in which steppers are made, is left out.
"""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from eeca_pymunk.arrays import FloatArray

from .output import Output, Row
from .program_run import PARTS
from .program_scenes import PROGRAMS
from .pymunk_examples import EXAMPLES

FRAMES = 300
REPEATS = 5
LIMIT = 600.0  # seconds for one run
CHOICES = dict.fromkeys((*EXAMPLES, *PROGRAMS))


def run(output: Output, full: bool, only: Sequence[str] = ()) -> None:
    """Run all programs, or only some; --full runs them for ten times as many frames."""
    frames = FRAMES * (10 if full else 1)
    names = list(only or CHOICES)
    if importlib.util.find_spec("pygame") is None:
        print('without pymunk\'s examples, which need pygame-ce: pip install "eeca-pymunk[examples]"')
        names = [name for name in names if name in PROGRAMS]
    output.parameters({"frames": frames, "runs": REPEATS})
    rows: list[Row] = []
    solvers = [*("native", "eeca") * REPEATS, "parts"]
    with tempfile.TemporaryDirectory() as folder:
        bar = tqdm(total=len(names) * len(solvers), desc="programs", unit="run", disable=None)
        for name in names:
            runs: dict[str, list[dict[str, Any]]] = {"native": [], "eeca": [], "parts": []}
            for solver in solvers:
                bar.set_postfix_str(f"{name}, {solver}")
                runs[solver].append(played(name, solver, frames, Path(folder)))
                bar.update()
            rows.append(told(name, **runs))
        bar.close()
    output.table("Steps of programs", rows)


def played(name: str, solver: str, frames: int, folder: Path) -> dict[str, Any]:
    """What a run in a process of its own tells; ends with what went wrong if it does not end well."""
    answer = folder / "answer.json"
    answer.unlink(missing_ok=True)
    environment = {**os.environ, "SDL_VIDEODRIVER": "dummy", "SDL_AUDIODRIVER": "dummy", "MPLBACKEND": "agg"}
    environment["PYTHONPATH"] = os.pathsep.join(p or os.getcwd() for p in sys.path)
    command = [sys.executable, "-m", "comparisons.program_run", name, solver, str(frames), str(answer)]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=LIMIT)
    if not answer.exists():
        return {"says": (done.stderr.strip().splitlines() or [f"ended with {done.returncode}"])[-1], "steps": []}
    found: dict[str, Any] = json.loads(answer.read_text())
    return found


def told(name: str, native: list[dict[str, Any]], eeca: list[dict[str, Any]], parts: list[dict[str, Any]]) -> Row:
    """The row of the table."""
    theirs, ours = least(native), least(eeca)
    one, inspected = eeca[0], parts[0]
    row: dict[str, Any] = {"program": name, "says": next((r["says"] for r in eeca if r["says"] != "runs"), "runs")}
    row |= dict.fromkeys(
        ("steps", "native us", "us", "to native", "native worst ms", "worst ms", "re-reads", "patches")
    )
    row |= dict.fromkeys(("objects read", "calls", "path", "around us", *(f"{part} us" for part in PARTS)))
    if len(theirs) and len(ours):
        row |= {
            "steps": len(ours), "native us": 1e6 * theirs.mean(), "us": 1e6 * ours.mean(),
            "to native": ours.mean() / theirs.mean(),
            "native worst ms": 1e3 * theirs.max(), "worst ms": 1e3 * ours.max(),
            "re-reads": one["reads"], "patches": one["patches"], "objects read": one["objects"],
            "calls": inspected.get("calls"),
            "path": one["path"] if {r["path"] for r in (*eeca, *parts)} == {one["path"]} else "differs",
        }  # fmt: skip
    if inspected["steps"]:
        spent = inspected["parts"]
        row["around us"] = 1e6 * (float(np.mean(inspected["steps"])) - sum(spent.values()))
        row |= {f"{part} us": 1e6 * spent[part] for part in PARTS}
    return row


def least(runs: list[dict[str, Any]]) -> FloatArray:
    """(steps,) the least time of each step over the runs (s), as far as all have come."""
    count = min(len(run["steps"]) for run in runs)
    steps: FloatArray = np.array([run["steps"][:count] for run in runs])
    fastest: FloatArray = steps.min(axis=0)
    return fastest
