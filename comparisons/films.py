"""The films of docs/films.md, each below 300 kB, ledgers below the runs that keep one. Takes --workers."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import eeca_pymunk as ep
import scenes
from comparisons import film, pool
from comparisons.output import Output
from eeca_pymunk import render
from eeca_pymunk.recorder import step_count

NAMES = (
    "carom", "pile", "drum", "billiard", "hopper", "cradle", "pool_break", "double_pendulum", "rods", "chain", "bridge",
    "lander", "walker",
)  # fmt: skip
LARGEST = 300_000  # bytes


def one(folder: Path, case: tuple[str, film.Film]) -> tuple[str, int]:
    """Film a scene, by its name and how it is filmed; the file and its size in bytes."""
    name, settings = case
    dt = settings.dt or scenes.build(name).dt
    duration = settings.duration or scenes.build(name).duration
    every = max(1, step_count(duration, dt) // (5 * settings.frames))
    recordings = []
    for stepper in settings.steppers:
        scene = scenes.build(name)
        recordings.append(ep.record(film.stepper(stepper, scene), duration, dt, every))
    titles = [film.STEPPERS[s][0] for s in settings.steppers]
    path = render.animate(
        recordings, folder / f"{name}.gif", 20, titles=titles, view=settings.view,
        exact=scenes.build(name).exact, frames=settings.frames, arrow=settings.arrow, dpi=settings.dpi,
    )  # fmt: skip
    return str(path), path.stat().st_size


def run(output: Output, full: bool, workers: int = 1) -> None:
    """Write the films; ValueError if one is too large."""
    made = pool.over(partial(one, output.folder), [(name, film.FILMS[name]) for name in NAMES], workers)
    output.table("Films", [{"film": path, "kB": size / 1000.0} for path, size in made])
    large = [path for path, size in made if size > LARGEST]
    if large:
        raise ValueError(
            f"{', '.join(large)}: larger than {LARGEST // 1000} kB; take fewer frames or dots (film.FILMS)"
        )
