"""docs/migrating.md, word for word: its edits fit pymunk's examples, which then run with our steps and no others."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "migrating.md").read_text(encoding="utf-8")
EDITS = dict(re.findall(r"`pymunk\.examples\.(\w+)`.*?```diff\n(.*?)```", PAGE, flags=re.DOTALL))
FRAMES = {"basic_test": 5000, "bouncing_balls": 240, "newtons_cradle": 240, "flipper": 240}


def edited(source: str, diff: str) -> str:
    """The source with the edits: every line that stays or goes has to be there, in this order, once from there on."""
    lines, place = source.split("\n"), 0
    for sign, text in ((line[0], line[1:]) for line in diff.splitlines()):
        if sign == "+":
            lines.insert(place, text)
            place += 1
            continue
        place += lines[place:].index(text)
        if sign == "-":
            del lines[place]
        else:
            place += 1
    return "import eeca_pymunk as ep\n" + "\n".join(lines)


def test_the_page_has_these_examples() -> None:
    assert EDITS.keys() == FRAMES.keys()


@pytest.mark.parametrize("name", sorted(FRAMES))
def test_an_example_runs_with_the_edits_of_the_page(name: str, tmp_path: Path) -> None:
    if name != "basic_test":
        pytest.importorskip("pygame")
    found = importlib.util.find_spec(f"pymunk.examples.{name}")
    assert found is not None
    assert found.origin is not None
    file = tmp_path / f"{name}.py"
    file.write_text(edited(Path(found.origin).read_text(), EDITS[name]))
    env = {**os.environ, "SDL_VIDEODRIVER": "dummy", "SDL_AUDIODRIVER": "dummy", "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "tests.programs.migrated", str(file), name, str(FRAMES[name])]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=env, timeout=120)
    assert done.returncode == 0, done.stderr
    ours, natives, residual, loss = done.stdout.splitlines()[-1].split()
    assert int(ours) >= FRAMES[name] - 1
    assert int(natives) == 0
    assert float(residual) < 1e-13
    if name == "newtons_cradle":
        assert float(loss) == 0.0  # nothing is damped
