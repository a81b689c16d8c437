"""The matrix of hard cases; a broken kernel makes one fail. That each case holds is in tests/oracles."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import eeca_pymunk as ep
import scenes
from comparisons import hard_cases
from comparisons.hard_cases import CASES, Case, matrix
from comparisons.output import Output
from eeca_pymunk.energy import balance

BY_NAME = {one.name: one for one in CASES}


def default(one: Case) -> float:
    found = hard_cases.figure(one, lambda space: ep.EECA(space, ep.TimeOfImpact(1000)))
    assert found is not None
    return found


def test_matrix_tells_passes_failures_and_refusals(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    some = [BY_NAME[name] for name in ("swap of velocities", "touching line of three", "rod onto its corner")]
    monkeypatch.setattr(matrix, "CASES", some)
    hard_cases.run(Output("hard_cases", tmp_path), False)
    printed = capsys.readouterr().out
    assert "TimeOfImpact 3, Midstep" in printed
    assert "Dashpot 1, native 10 2, native 100 2" in printed
    assert "refused" in printed
    assert (tmp_path / "hard_cases.png").exists()
    assert (tmp_path / "hard_cases.csv").exists()


# In plain Python, where kernels can be exchanged: what replaces one, and the case that must notice.
BROKEN = {
    "walls that take a thousandth": (
        "single.law",
        "lambda of: lambda *a: (0.999 * of(*a)[0], *of(*a)[1:])",
        "slow ball, v = 1 to 1e-4",
    ),
    "impacts a thousandth late": (
        "impact_times.meet_in_free_fall",
        "lambda of: lambda *a: of(*a) + 1e-3",
        "pi, mass ratio 1e4",
    ),
    "impulses at the centres of mass": (
        "build.place_row",
        "lambda of: lambda row, *a: (of(row, *a), [row.__setitem__(arm, 0.0) for arm in ARMS])[0]",
        "rod onto its corner",
    ),
    "nothing touches": (
        "single.touches",
        "lambda of: lambda *a: False",
        "touching line of three",
    ),
    "jointed bodies a millionth too far": (
        "motion.move",
        "lambda of: lambda local, bodies, h: of(local, bodies, 1.000001 * h)",
        "bead in a groove",
    ),
    "limits a millionth too late": (
        "bounds.limit_gap",
        "lambda of: lambda *a: of(*a) + 1e-6",
        "ratchet",
    ),
}
_BREAK = """
import sys
from comparisons import hard_cases
import eeca_pymunk as ep
from eeca_pymunk import compiled
from eeca_pymunk.contacts import single
from eeca_pymunk.prediction import impact_times
from eeca_pymunk.joints import bounds
from eeca_pymunk.newton import motion
from eeca_pymunk.rows import build
ARMS = ["arm_na", "arm_nb", "arm_ta", "arm_tb"]
compiled.prepare()
where, how, name = sys.argv[1:]
room, kernel = where.split(".")
if how:
    one = getattr(globals()[room], kernel)
    one.run = eval(how)(one.run)
case = next(c for c in hard_cases.CASES if c.name == name)
found = hard_cases.figure(case, lambda space: ep.EECA(space, ep.TimeOfImpact(20)))
print(found is not None and found <= case.limit)
"""


@pytest.mark.parametrize("broken", [False, True], ids=["whole", "broken"])
@pytest.mark.parametrize("one", BROKEN.values(), ids=BROKEN.keys())
def test_a_broken_kernel_fails_a_case(one: tuple[str, str, str], broken: bool) -> None:
    where, how, name = one
    done = subprocess.run(
        [sys.executable, "-c", _BREAK, where, how if broken else "", name],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"},
        cwd=Path(__file__).parent.parent,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split()[-1] == str(not broken)


def test_a_disabled_lock_fails_a_crowded_case(monkeypatch: pytest.MonkeyPatch) -> None:
    def drift() -> float:
        scene = scenes.build("hopper", columns=9, layers=9)
        stepper = ep.EECA(scene.space, ep.Dashpot(1e6, 200.0, tolerance=1e-2, max_iterations=2), sync=False)
        start = ep.measure(scene.space).energy
        for _ in range(130):
            stepper.step(scene.dt)
        return abs(ep.measure(scene.space).energy / start - 1.0)

    assert drift() <= 1e-12
    lock = balance.energy_lock

    def unlocked(*arguments: object) -> balance.Lock:
        found = lock(*arguments)  # type: ignore[arg-type]
        return balance.Lock(np.ones_like(found.scale), found.valid)

    monkeypatch.setattr(balance, "energy_lock", unlocked)
    assert drift() > 1e-9
