"""pymunk's own examples under both solvers: which run, what a step costs, the last frame side by side.

Each example is run as it is, twice, in a process of its own, with SDL's dummy drivers and made-up keys and mouse, for
300 frames; once more with `Space.step` replaced by ours. Needs pygame-ce: pip install "eeca-pymunk[examples]".
"""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from PIL import Image
from tqdm import tqdm

from .output import Output, Row

# Those that need neither a window nor another library than pygame.
EXAMPLES = (
    "arrows", "balls_and_lines", "basic_test", "bouncing_balls", "box2d_pyramid", "breakout", "camera", "collisions",
    "colors", "constraints", "contact_and_no_flipy", "contact_with_friction", "copy_and_pickle",
    "damped_rotary_spring_pointer", "deformable", "flipper", "index_video", "newtons_cradle", "planet", "platformer",
    "playground", "point_query", "slide_and_pinjoint", "tank", "threaded_space", "using_sprites",
)  # fmt: skip
FRAMES = 300
LIMIT = 600.0  # seconds for one run
_FRAME = 16.0  # milliseconds that a game has


def run(output: Output, full: bool) -> None:
    """Run all examples; --full runs them for ten times as many frames."""
    if importlib.util.find_spec("pygame") is None:
        print('needs pygame-ce: pip install "eeca-pymunk[examples]"')
        return
    frames = FRAMES * (10 if full else 1)
    output.parameters({"frames": frames, "limit of a step (ms)": _FRAME})
    with tempfile.TemporaryDirectory() as folder:
        bar = tqdm(EXAMPLES, desc="examples", unit="example", disable=None)
        rows = [example(name, frames, Path(folder), output) for name in bar]
    output.table("pymunk's examples, Space.step replaced", rows)
    ran = [row for row in rows if row["ours"] == "runs"]
    slow = [row["example"] for row in ran if float(row["worst ms"] or 0.0) > _FRAME]
    print(f"{len(ran)} of {len(rows)} run; a step of more than {_FRAME:g} ms: {', '.join(map(str, slow)) or 'none'}")


def example(name: str, frames: int, folder: Path, output: Output | None = None) -> Row:
    """One example under both; the row of the table."""
    theirs, ours = (_played(name, solver, frames, folder) for solver in ("native", "eeca"))
    if output is not None and theirs["picture"] and ours["picture"]:
        _side_by_side(Path(theirs["picture"]), Path(ours["picture"]), output.path("png", name))
    return {
        "example": name,
        "native": theirs["says"],
        "ours": ours["says"],
        "steps": ours["steps"],
        "native ms": theirs["mean"],
        "ours ms": ours["mean"],
        "native worst ms": theirs["worst"],
        "worst ms": ours["worst"],
        "residual": ours["residual"],
        "unconverged": ours["unconverged"],
    }


def _played(name: str, solver: str, frames: int, folder: Path) -> dict[str, Any]:
    """What the run in a process of its own tells."""
    answer = folder / f"{name}_{solver}.json"
    environment = {**os.environ, "SDL_VIDEODRIVER": "dummy", "SDL_AUDIODRIVER": "dummy", "MPLBACKEND": "agg"}
    environment["PYTHONPATH"] = os.pathsep.join(p or os.getcwd() for p in sys.path)
    command = [sys.executable, "-m", "comparisons.play", name, solver, str(frames), str(answer)]
    try:
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=LIMIT)
        told = done.stderr.strip().splitlines()
        says = told[-1] if told else f"ended with {done.returncode}"
    except subprocess.TimeoutExpired:
        says = f"not done in {LIMIT:g} s"
    if answer.exists():
        found: dict[str, Any] = json.loads(answer.read_text())
        return found
    return {"says": says, "steps": 0, "mean": None, "worst": None, "residual": None, "unconverged": None, "picture": ""}


def _side_by_side(left: Path, right: Path, path: Path) -> None:
    """Native's last frame on the left, ours on the right."""
    pictures = [Image.open(one).convert("RGB") for one in (left, right)]
    both = Image.new("RGB", (sum(p.width for p in pictures) + 4, max(p.height for p in pictures)), "white")
    both.paste(pictures[0], (0, 0))
    both.paste(pictures[1], (pictures[0].width + 4, 0))
    both.save(path)
