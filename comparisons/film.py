"""The scene of a comparison under several steppers side by side, as a film with its table and pictures."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

import eeca_pymunk as ep
import scenes
from comparisons import runs
from comparisons.output import Output, Row
from eeca_pymunk import render
from eeca_pymunk.errors import NotFiniteError
from eeca_pymunk.files import check_writable
from eeca_pymunk.recorder import step_count
from eeca_pymunk.render.encode import encoder
from scenes import Scene

# By the names of the command line: the title, and the name in `runs.steppers`.
STEPPERS = {
    "eeca": ("EECA", "EECA TimeOfImpact"),
    "midstep": ("EECA, Midstep", "EECA Midstep"),
    "dashpot": ("EECA, Dashpot", "EECA Dashpot xi=200"),
    "native": ("pymunk", "native default"),
    "tuned": ("pymunk tuned", "native tuned 50"),
    "trapezoidal": ("trapezoidal", "trapezoidal"),
    "max_dissipation": ("max dissipation", "max dissipation"),
}
_MOMENTS = 5  # kept for each frame
FORMATS = ("gif", "mp4", "html")
View = tuple[float, float, float, float]


@dataclass(frozen=True)
class Film:
    """How a scene is filmed: under which steppers, for how long (s, the scene's if None), and what of it (m).

    `view` is None where all that moves is to be seen: the limits are those of all motions shown. It is given where
    walls or bodies far outside would make the rest small.
    """

    steppers: tuple[str, ...] = ("eeca", "native")
    duration: float | None = None
    view: View | None = None
    arrow: str | None = None
    dt: float | None = None
    frames: int = 48
    dpi: float = 76


FILMS = {
    "carom": Film(("eeca", "native", "trapezoidal", "max_dissipation"), 1.5),
    "pool_break": Film(duration=0.06, arrow="momentum", view=(-0.46, 0.46, -0.95, 0.78), frames=40, dpi=64),
    "hopper": Film(view=(-0.7, 0.7, -0.15, 1.1), dt=0.001),
    "pile": Film(duration=3.0, view=(-0.5, 9.5, -0.3, 11.0), frames=36, dpi=68),
    "drum": Film(duration=3.0, frames=40, dpi=66),
    "billiard": Film(duration=1.0),
    "cradle": Film(duration=0.3, dt=0.001, frames=40),
    "double_pendulum": Film(duration=6.0),
    "rods": Film(duration=8.0, frames=56),
    "bridge": Film(duration=4.0),
    "chain": Film(duration=3.0),
    "lander": Film(duration=7.0, view=(-6.0, 6.0, -0.5, 7.0)),
    "walker": Film(duration=8.0, view=(-2.0, 2.8, -0.3, 2.2), dt=1 / 200, frames=64),
}


def options(steppers: str | None, suffix: str | None, name: str) -> tuple[list[str], str | None]:
    """The steppers of a comma-separated list and the format, checked; ValueError with the remedy."""
    if name not in scenes.NAMES:
        raise ValueError(f"{name} has no single scene to show: choose one of {', '.join(scenes.NAMES)}")
    chosen = list(FILMS.get(name, Film()).steppers) if steppers is None else steppers.split(",")
    for stepper in chosen:
        if stepper not in STEPPERS:
            raise ValueError(f"unknown stepper {stepper!r}: choose from {', '.join(STEPPERS)}")
    if suffix is not None:
        encoder(f".{suffix}")
        if len(chosen) > 4:
            raise ValueError(f"{len(chosen)} steppers: a film shows one to four")
    return chosen, suffix


def run(
    output: Output, steppers: list[str], suffix: str | None, dt: float | None, duration: float | None, frames: int,
    fps: float,
) -> None:  # fmt: skip
    """Run the scene under each stepper; print the table, write CSV, PNG and, with a suffix, the film."""
    settings = FILMS.get(output.name, Film())
    scene = scenes.build(output.name)
    dt = (settings.dt or scene.dt) if dt is None else dt
    duration = (settings.duration or scene.duration) if duration is None else duration
    # More moments than frames: paths are drawn through all of them.
    every = max(1, step_count(duration, dt) // (_MOMENTS * frames))
    path = check_writable(output.path(suffix)) if suffix is not None else None
    output.parameters({**scene.parameters, "dt": dt, "duration": duration, "every": every})
    recordings: list[ep.Recording] = []
    times_taken: list[float] = []
    for name in steppers:
        # A scene may depend on its dt only through its default.
        scene = scenes.build(output.name)
        try:
            begun = time.perf_counter()
            recordings.append(ep.record(stepper(name, scene), duration, dt, every, progress=True))
            times_taken.append((time.perf_counter() - begun) / step_count(duration, dt))
        except NotFiniteError as error:
            raise ValueError(
                f"{STEPPERS[name][0]} blew up ({error}); leave it out, or give a shorter --duration"
            ) from error
    titles = [STEPPERS[name][0] for name in steppers]
    output.table(f"{output.name}: dt = {dt:g} s, {duration:g} s", [
        {**_row(title, recording, scene), "ms/step": 1e3 * seconds}
        for title, recording, seconds in zip(titles, recordings, times_taken, strict=True)
    ], "film")  # fmt: skip
    times = np.linspace(0.0, float(recordings[0].time[-1]), 4).tolist()
    for name, title, recording in zip(steppers, titles, recordings, strict=True):
        output.picture(render.strip(recording, times, title=title, view=settings.view), f"film_{name}")
    if path is not None:
        begun = time.perf_counter()
        render.animate(
            recordings, path, fps, titles=titles, exact=scene.exact, view=settings.view, frames=frames,
            arrow=settings.arrow, dpi=settings.dpi, progress=True,
        )  # fmt: skip
        print(f"-> {path} ({frames} frames of {len(recordings)} panels in {time.perf_counter() - begun:.1f} s)")


def stepper(name: str, scene: Scene) -> ep.Stepper:
    """A stepper for a scene, by its name on the command line."""
    make = ep.EECA if name == "eeca" else runs.steppers(scene.stiffness)[STEPPERS[name][1]]
    return make(scene.space)


def _row(title: str, recording: ep.Recording, scene: Scene) -> Row:
    drift = recording.energy / recording.energy[0] - 1.0 if recording.energy[0] else recording.energy
    exact = scene.exact(float(recording.time[-1]))
    error = None if exact is None else float(np.linalg.norm(recording.position[-1] - exact, axis=1).max())
    return {
        "stepper": title, "error (m)": error, "max |dE/E|": float(np.abs(drift).max()), "dE/E at end": float(drift[-1]),
        "px at end": float(recording.momentum[-1, 0]), "py at end": float(recording.momentum[-1, 1]),
    }  # fmt: skip
