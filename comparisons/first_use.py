"""First use: seconds of an import and of a first step; of building the library, and of building it after an edit."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from tqdm import tqdm

import eeca_pymunk as ep
from comparisons.output import Output, Row
from eeca_pymunk.compiled.backend import cannot_build
from eeca_pymunk.compiled.sources import sources_hash

_STEPS = """
import time
start = time.perf_counter()
import numpy, pymunk
base = time.perf_counter() - start
import eeca_pymunk as ep
package = time.perf_counter() - start - base
import scenes
space = scenes.build("heap").space  # boxes and disks in pairs: contacts, friction, joints
begin = time.perf_counter()
ep.EECA(space).step(1e-2)
print(base, package, time.perf_counter() - begin, time.perf_counter() - start)
"""
# A file of each room, in which the last digit of the first number in a kernel is changed.
EDITS = {
    "geometry": "geometry/gap.py",
    "pairs": "pairs/grid.py",
    "prediction": "prediction/impact_times.py",
    "rows": "rows/sweeps.py",
    "contacts": "contacts/interval.py",
    "islands": "islands/intervals.py",
    "impacts": "impacts/simultaneous.py",
    "joints": "newton/solve.py",
    "jointed": "jointed/iteration.py",
    "none (a comment)": "impacts/scene.py",
}

_NUMBER = re.compile(
    r"^@(?:kernel|nonallocating|inlined)\n(?:.*\n)*?    "
    r'"""(?:.|\n)*?"""\n(?:.*\n)*?.*?\b(\d*[1-9]\d*\.\d+|\d+\.\d*[1-9])\b',
    re.MULTILINE,
)


def look(looks: int = 5) -> list[Row]:
    """Seconds of imports, and of a first step of a heap with joints and friction, each in a process of its own."""
    root = Path(ep.__file__).parents[1]
    found = []
    for _ in range(looks):
        done = subprocess.run(
            [sys.executable, "-c", _STEPS], env=_environment(root), capture_output=True, text=True, check=True
        )
        found.append([float(word) for word in done.stdout.split()])
    base, package, step, whole = np.median(found, axis=0)
    return [
        {"what": "import numpy, pymunk", "s": float(base)},
        {"what": "import eeca_pymunk after them", "s": float(package)},
        {"what": "first step of a heap with joints and friction", "s": float(step)},
        {"what": "all of it", "s": float(whole)},
    ]


def _environment(root: Path, **more: str) -> dict[str, str]:
    return os.environ | {"PYTHONPATH": str(root), "PYTHONDONTWRITEBYTECODE": "1"} | more


def _build(folder: Path) -> Row:
    """Seconds and stages of a build of the package in this folder."""
    start = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "eeca_pymunk.build"],
        cwd=folder, env=_environment(folder, EECA_PYMUNK_CACHE=str(folder / "store")), capture_output=True, text=True,
    )  # fmt: skip
    if done.returncode:
        raise RuntimeError(done.stderr)
    took = time.perf_counter() - start
    stage = {name: sum(map(float, re.findall(rf"{name}[^\d]*?(?:x86_64|aarch64)? ([\d.]+) s", done.stdout)))
             for name in ("compiling kernels", "machine code")}  # fmt: skip
    return {"s": took, "compiling kernels (s)": stage["compiling kernels"], "machine code (s)": stage["machine code"]}


def builds() -> list[Row]:
    """A first build of a copy of the package, and one after an edit in each room."""
    root = Path(ep.__file__).parent
    rows: list[Row] = []
    with tempfile.TemporaryDirectory() as name, tqdm(total=1 + len(EDITS), desc="builds") as bar:
        folder = Path(name)
        copy = folder / "eeca_pymunk"
        shutil.copytree(root, copy, ignore=shutil.ignore_patterns("__pycache__", "libraries"))
        rows.append({"edit in": "nothing is there yet", **_build(folder)})
        bar.update()
        for room, file in EDITS.items():
            path = copy / file
            text = path.read_text(encoding="utf-8")
            if room.startswith("none"):
                edited = f"{text}# An edit that no kernel sees.\n"
            else:
                at = _NUMBER.search(text).end(1)  # type: ignore[union-attr]
                edited = f"{text[:at]}000000000001{text[at:]}"
            path.write_text(edited, encoding="utf-8")
            rows.append({"edit in": f"{room}: {file}", **_build(folder)})
            bar.update()
    return rows


def run(output: Output, full: bool) -> None:
    """Print the tables, write CSV."""
    output.parameters({"sources": sources_hash()})
    output.table("First use, machine code installed", look(), "first_use")
    if reason := cannot_build():
        print(f"no builds: {reason}")
        return
    output.table("Building the library", builds(), "builds")
