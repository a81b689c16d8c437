"""First use: seconds of compiling after installation, and of an import."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import eeca_pymunk as ep
from comparisons.output import Row

_FIRST_USE = """
import time
start = time.perf_counter()
import numpy, pymunk
base = time.perf_counter() - start
import eeca_pymunk as ep
print(base, time.perf_counter() - start - base)
if {step}:
    import scenes
    for scene in (scenes.build("gas", count=20), scenes.build("mixed", bowl=True)):
        begin = time.perf_counter()
        ep.EECA(scene.space).step(1e-3)
        print(time.perf_counter() - begin)
"""


def _fresh(folder: Path, step: bool) -> list[float]:
    """Seconds in a process of its own: numpy and pymunk, the package after them, and the first steps."""
    call = [sys.executable, "-c", _FIRST_USE.format(step=step)]
    answer = subprocess.run(call, cwd=folder, capture_output=True, text=True, check=True)
    return [float(word) for word in answer.stdout.split()]


def look(looks: int = 5) -> list[Row]:
    """Seconds of a first step after installation, with machine code on disk, and of an import alone."""
    root = Path(ep.__file__).parents[1]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for package in ("eeca_pymunk", "scenes"):
            shutil.copytree(root / package, folder / package, ignore=shutil.ignore_patterns("__pycache__"))
        cold = _fresh(folder, True)
        warm = np.median([_fresh(folder, True) for _ in range(looks)], axis=0)
        imports = np.median([_fresh(folder, False) for _ in range(looks)], axis=0)
    return [
        {"what": "first step of disks after installation: compiling", "s": cold[2]},
        {"what": "first step of turning shapes after that", "s": cold[3]},
        {"what": "first step of disks, machine code on disk", "s": float(warm[2])},
        {"what": "first step of turning shapes after that", "s": float(warm[3])},
        {"what": "import numpy, pymunk", "s": float(imports[0])},
        {"what": "import eeca_pymunk after them", "s": float(imports[1])},
    ]
