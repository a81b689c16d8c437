"""Ten thousand random programs of API calls: `python -m tests.programs.soak [COUNT] [--minutes M] [--joints]`.

`--compositions` plays random scenes of `varied.py` in their place (`--rare`: of `rare.py`), and prints the longest step
of all; with `--off RULE` under a copy of the package without one of its heuristics (`comparisons.ablation.OFF`).

Goes on after a failure, and prints its seed and calls; with `--shrink`, which draws more slowly and less widely, the
shortest program that fails in the same way, with what was drawn. `--gain 1e-5` takes a gain of energy above that part
of the scale for a failure (see `fuzz.Program`).
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
import traceback

from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st
from tqdm import tqdm

from comparisons.ablation import package_without

from .compositions import Broken
from .fuzz import GAIN, Drawn, Program, Thrown
from .rare import Rare
from .varied import Varied

_BATCH = 100  # programs between two looks at the clock


def batch(count: int, start: int, gain: float, joints: bool, length: int) -> str:
    """Play so many programs that begin at a seed; what fails, empty if nothing does."""

    @seed(start)
    @settings(
        max_examples=count, deadline=None, database=None, report_multiple_bugs=False,
        suppress_health_check=list(HealthCheck),
    )  # fmt: skip
    @given(st.data())
    def programs(data: st.DataObject) -> None:
        Program(Drawn(data), gain, joints).play(length)

    try:
        programs()
    except Exception as error:
        return "\n".join((f"{type(error).__name__}: {error}", *getattr(error, "__notes__", ())))
    return ""


def plain(count: int, start: int, gain: float, joints: bool, length: int) -> str:
    """As `batch`, of seeds from `start` on; all that fail."""
    told = []
    for one in range(start, start + count):
        chance = Thrown(one)
        try:
            Program(chance, gain, joints).play(length)
        except Exception as error:
            told.append(f"seed {one}: {type(error).__name__}: {error}\n{' '.join(chance.calls)}")
    return "\n".join(told)


def compositions(count: int, minutes: float, start: int, joints: bool, kind: type[Varied]) -> int:
    """Play so many compositions, or for so long; how many break a law or have a step that takes too long."""
    clock, failed, longest, unconverged, late, done = time.perf_counter(), 0, 0.0, 0, 0, 0
    with tqdm(total=count, unit="scene", desc="compositions") as bar:
        while done < count and time.perf_counter() - clock < 60.0 * minutes:
            try:
                found = kind(start + done, joints).play()
                longest, unconverged = max(longest, found.longest), unconverged + found.unconverged
                if found.late:
                    tqdm.write(f"seed {start + done}: a step takes too long")
                late += found.late
            except Exception as error:
                failed += 1
                told = str(error) if isinstance(error, Broken) else traceback.format_exc()
                tqdm.write(f"seed {start + done}: {type(error).__name__}: {told}")
            done += 1
            bar.update(1)
    spent = time.process_time() / max(done, 1)
    print(f"{done} compositions, {failed} fail, longest step {1e3 * longest:.0f} ms, {late} take too long", end=", ")
    print(f"{unconverged / max(done, 1):.2f} steps of each not converged, {spent:.2f} s each")
    return failed + late


def soak(count: int, minutes: float, start: int, gain: float, joints: bool, shrink: bool, length: int = 40) -> int:
    """Play so many programs, or for so long; how many batches fail."""
    clock, failed, done = time.perf_counter(), 0, 0
    with tqdm(total=count, unit="program", desc="soak") as bar:
        while done < count and time.perf_counter() - clock < 60.0 * minutes:
            size = min(_BATCH, count - done)
            if told := (batch if shrink else plain)(size, start + done, gain, joints, length):
                failed += 1
                tqdm.write(f"seed {start + done}, gain {gain:g}:\n{told}\n")
            done += size
            bar.update(size)
            bar.set_postfix_str(f"{failed} batches fail")
    print(f"{done} programs in {time.perf_counter() - clock:.0f} s, {failed} batches of {_BATCH} fail")
    return failed


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", type=int, nargs="?", default=10_000)
    parser.add_argument("--minutes", type=float, default=float("inf"))
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--gain", type=float, default=GAIN)
    parser.add_argument("--joints", action="store_true", help="join bodies, too")
    parser.add_argument("--compositions", action="store_true", help="scenes in containers that turn and shake")
    parser.add_argument("--rare", action="store_true", help="compositions with the bodies of rare.py")
    parser.add_argument("--shrink", action="store_true", help="draw by hypothesis, and shrink what fails")
    parser.add_argument("--off", help="a heuristic, of compositions")
    one = parser.parse_args()
    if one.off:
        arguments = [word for word in sys.argv[1:] if word not in ("--off", one.off)]
        with package_without(one.off, "scenes", "comparisons", "tests") as (folder, environment):
            command = [sys.executable, "-m", "tests.programs.soak", *arguments]
            raise SystemExit(subprocess.run(command, cwd=folder, env=environment).returncode)
    if one.compositions:
        raise SystemExit(
            min(compositions(one.count, one.minutes, one.seed, one.joints, Rare if one.rare else Varied), 1)
        )
    raise SystemExit(min(soak(one.count, one.minutes, one.seed, one.gain, one.joints, one.shrink), 1))
