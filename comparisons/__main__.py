"""`python -m comparisons` lists the comparisons; `python -m comparisons NAME [--out DIR]` runs one."""

from __future__ import annotations

import argparse
import inspect
import math
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import scenes

from . import film
from .output import Output

NAMES = (
    "programs",
    "features",
    "tour",
    "signorini",
    "carom",
    "cradle",
    "pool_break",
    "hopper",
    "work_precision",
    "scaling",
    "first_use",
    "detection",
    "piles",
    "crowds",
    "ablation",
    "joints",
    "robots",
    "sleeping",
    "rollouts",
    "datasets",
    "meeting",
    "soak",
    "pymunk_examples",
    "hard_cases",
    "maxwell",
    "engines",
    "films",
    "gallery",
)


def command_line() -> argparse.ArgumentParser:
    """What the command line takes."""
    parser = argparse.ArgumentParser(prog="python -m comparisons", description="Run a comparison of time steppers.")
    parser.add_argument("name", nargs="?", help="the comparison; none lists them")
    parser.add_argument("--out", type=Path, default=Path("out"), help="folder for CSV and PNG (default: out)")
    parser.add_argument("--full", action="store_true", help="also the runs that take minutes each")
    parser.add_argument("--workers", type=int, help="processes, for comparisons that run many cases (default: 1)")
    parser.add_argument("--only", help="a list with commas, for comparisons that run many programs (default: all)")
    shown = parser.add_argument_group("the comparison's scene side by side, instead of the whole comparison")
    shown.add_argument("--animate", choices=film.FORMATS, help="write a film in this format")
    shown.add_argument("--steppers", help=f"from {','.join(film.STEPPERS)}; a film shows up to four")
    shown.add_argument("--dt", type=float, help="time step (s)")
    shown.add_argument("--duration", type=float, help="simulated time (s)")
    shown.add_argument("--frames", type=int, default=48, help="of the film, about (default: 48)")
    shown.add_argument("--fps", type=float, default=20.0, help="frames per second (default: 20)")
    return parser


def main(arguments: list[str] | None = None) -> int:
    """Run the command line; the exit status."""
    options = command_line().parse_args(arguments)
    if options.name is None:
        for name in NAMES:
            title = (import_module(f".{name}", __package__).__doc__ or "").splitlines()[0]
            print(f"{name:16} {title}")
        print("\nRun one with: python -m comparisons NAME --out DIR; film its scene with --animate gif")
        return 0
    side_by_side = any(x is not None for x in (options.animate, options.steppers, options.dt, options.duration))
    try:
        if side_by_side:
            _film(options)
            return 0
        if options.name not in NAMES:
            raise ValueError(f"unknown comparison {options.name!r}: choose one of {', '.join(NAMES)}")
        run, extra = chosen(options)
        output = Output(options.name, options.out)
    except (ValueError, OSError) as error:
        print(f"python -m comparisons: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return _interrupted()
    try:
        run(output, options.full, **extra)
    except KeyboardInterrupt:
        return _interrupted()
    return 0


def chosen(options: argparse.Namespace) -> tuple[Callable[..., None], dict[str, Any]]:
    """What runs the comparison, `run(output, full)`, and what it takes besides."""
    module = import_module(f".{options.name}", __package__)
    run: Callable[..., None] = module.run
    extra: dict[str, Any] = {}
    if options.only is not None:
        known: dict[str, Any] = getattr(module, "CHOICES", {})
        if not known:
            raise ValueError(f"{options.name} has no parts to choose from: leave --only out")
        names = options.only.split(",")
        if unknown := [name for name in names if name not in known]:
            raise ValueError(f"--only {unknown[0]!r}: choose from {','.join(known)}")
        extra["only"] = names
    if options.workers is None:
        return run, extra
    if options.workers < 1:
        raise ValueError(f"--workers {options.workers}: give a number >= 1")
    if "workers" not in inspect.signature(run).parameters:
        raise ValueError(f"{options.name} measures times or runs few cases: leave --workers out")
    return run, extra | {"workers": options.workers}


def _film(options: argparse.Namespace) -> None:
    if options.name not in {*NAMES, *scenes.NAMES}:
        raise ValueError(f"unknown comparison {options.name!r}: choose one of {', '.join(NAMES)}")
    if options.frames < 1 or not options.fps > 0:
        raise ValueError(f"--frames {options.frames} --fps {options.fps}: give numbers > 0")
    for value, name in ((options.dt, "--dt"), (options.duration, "--duration")):
        if value is not None and not (value > 0 and math.isfinite(value)):
            raise ValueError(f"{name} {value}: give a finite number > 0")
    chosen, suffix = film.options(options.steppers, options.animate, options.name)
    output = Output(options.name, options.out)
    film.run(output, chosen, suffix, options.dt, options.duration, options.frames, options.fps)


def _interrupted() -> int:
    print("python -m comparisons: interrupted; files that were not finished are not there", file=sys.stderr)
    return 130


if __name__ == "__main__":
    sys.exit(main())
