"""Work against precision where contacts last: a block on a slope, a column that lands, a few disks that settle.

The block has exact solutions, slipping and sticking; so has the column without elasticity: each body falls freely until
it lands on the one below, which has landed before. Disks that settle are compared with fine steps of EECA and, as a
check of that, of pymunk.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pymunk
from matplotlib.figure import Figure
from tqdm import tqdm

import eeca_pymunk as ep
from comparisons.output import Output, Row
from comparisons.runs import FloatArray, slope
from eeca_pymunk import render

G = 9.81  # m/s²
STEPS = (1 / 30, 1 / 60, 1 / 120, 1 / 240, 1 / 480, 1 / 960)  # s
FINE = 1 / 15360  # s, of references
FLOOR = 1e-16  # m; where a picture draws an error of zero
EECA = "EECA"
Make = Callable[[], tuple[pymunk.Space, list[pymunk.Body]]]


@dataclass(frozen=True)
class Problem:
    """A space, how long to run it (s), and where its bodies are then: (n, 2), None if only fine steps tell."""

    name: str
    build: Make
    duration: float
    end: FloatArray | None


def _block(angle: float, friction: float) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """A block 1 x .5 at rest on a slope that falls to the right."""
    space = pymunk.Space()
    space.gravity = (0.0, -G)
    along = np.array([math.cos(angle), -math.sin(angle)])
    wall = pymunk.Segment(space.static_body, tuple(-50.0 * along), tuple(50.0 * along), 0.0)
    body = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (1.0, 0.5)))
    body.position, body.angle = (0.25 * math.sin(angle), 0.25 * math.cos(angle)), -angle
    box = pymunk.Poly.create_box(body, (1.0, 0.5))
    wall.friction, box.friction = 1.0, friction
    space.add(body, box, wall)
    return space, [body]


def block(angle: float, friction: float, duration: float = 1.0) -> Problem:
    """x = g (sin - mu cos) t²/2 along the slope, 0 if tan <= mu."""
    pull = max(0.0, G * (math.sin(angle) - friction * math.cos(angle)))
    start = np.array([0.25 * math.sin(angle), 0.25 * math.cos(angle)])
    end = start + 0.5 * pull * duration**2 * np.array([math.cos(angle), -math.sin(angle)])
    name = "slips" if pull > 0.0 else "sticks"
    return Problem(f"block that {name}", lambda: _block(angle, friction), duration, end[None])


def _column(count: int, gap: float) -> tuple[pymunk.Space, list[pymunk.Body]]:
    space, bodies = pymunk.Space(), []
    space.gravity = (0.0, -G)
    floor = pymunk.Segment(space.static_body, (-5.0, 0.0), (5.0, 0.0), 0.0)
    floor.friction = 1.0
    space.add(floor)
    for i in range(count):
        body = pymunk.Body(1.0, 1.0 / 6.0)
        body.position = (0.0, 0.5 + i + gap * (i + 1) ** 2)
        box = pymunk.Poly.create_box(body, (1.0, 1.0))
        box.friction = 0.5
        space.add(body, box)
        bodies.append(body)
    return space, bodies


def column(count: int = 5, gap: float = 0.05, duration: float = 0.5) -> Problem:
    """Boxes above each other: y = max(place at rest, start - g t²/2), for the lower always land first."""
    rest = 0.5 + np.arange(count)
    y = np.maximum(rest, rest + gap * np.arange(1, count + 1) ** 2 - 0.5 * G * duration**2)
    return Problem("column that lands", lambda: _column(count, gap), duration, np.column_stack((np.zeros(count), y)))


def _heap() -> tuple[pymunk.Space, list[pymunk.Body]]:
    space, bodies = pymunk.Space(), []
    space.gravity = (0.0, -G)
    for a, b in (((-3.0, 1.0), (0.0, 0.0)), ((0.0, 0.0), (3.0, 1.0))):
        wall = pymunk.Segment(space.static_body, a, b, 0.0)
        wall.elasticity = wall.friction = 1.0
        space.add(wall)
    for x, y in ((-0.9, 1.0), (0.8, 1.1), (-0.1, 2.3)):
        body = pymunk.Body(1.0, 0.125)
        body.position = (x, y)
        disk = pymunk.Circle(body, 0.5)
        disk.elasticity, disk.friction = 0.3, 0.5
        space.add(body, disk)
        bodies.append(body)
    return space, bodies


def problems() -> list[Problem]:
    """All of them."""
    return [
        block(math.radians(20.0), 0.2),
        block(math.radians(20.0), 0.5),
        column(),
        Problem("disks", _heap, 1.0, None),
    ]


@dataclass
class Point:
    """One run: the largest error of a place (m) at the end, and its time (s)."""

    problem: str
    stepper: str
    dt: float
    error: float
    seconds: float


def _run(problem: Problem, stepper: str, dt: float) -> tuple[FloatArray, float]:
    """Places at the end, and the seconds that took."""
    space, bodies = problem.build()
    step: Callable[[float], object]
    if stepper == EECA:
        step = ep.EECA(space, sync=False).step
    else:
        space.iterations = int(stepper.split()[1])
        step = space.step
    count = round(problem.duration / dt)
    begin = time.process_time()
    for _ in range(count):
        step(dt)
    spent = time.process_time() - begin
    return np.array([b.position for b in bodies]), spent


STEPPERS = (EECA, "native 10", "native 100")


def measure(problem: Problem, steps: tuple[float, ...] = STEPS, fine: float = FINE) -> tuple[list[Point], float]:
    """Every stepper at every dt, and how far two references are apart: 0 where the end is known."""
    end, apart = problem.end, 0.0
    if end is None:
        end = _run(problem, EECA, fine)[0]
        apart = float(np.hypot(*(end - _run(problem, "native 100", fine)[0]).T).max())
    _run(problem, EECA, steps[0])  # compiled before the clock runs
    points = []
    for stepper in STEPPERS:
        for dt in steps:
            place, seconds = min((_run(problem, stepper, dt) for _ in range(3)), key=lambda found: found[1])
            points.append(Point(problem.name, stepper, dt, float(np.hypot(*(place - end).T).max()), seconds))
    return points, apart


def slopes(points: list[Point]) -> list[Row]:
    """Exponents of the error in dt and in time, over all dt; none where errors are round-off."""
    rows: list[Row] = []
    for problem in dict.fromkeys(p.problem for p in points):
        for stepper in STEPPERS:
            mine = [p for p in points if p.problem == problem and p.stepper == stepper]
            if not mine:
                continue
            error = np.array([p.error for p in mine])
            told = bool((error > 1e-11).all())
            rows.append({
                "problem": problem, "stepper": stepper, "largest error (m)": float(error.max()),
                "smallest error (m)": float(error.min()),
                "slope in dt": slope(np.array([p.dt for p in mine]), error) if told else None,
                "slope in time": slope(np.array([p.seconds for p in mine]), error) if told else None,
            })  # fmt: skip
    return rows


def run(output: Output) -> None:
    """Print the tables; write CSV and a picture."""
    points: list[Point] = []
    for problem in tqdm(problems(), desc="precision", disable=None):
        found, apart = measure(problem)
        points += found
        if problem.end is None:
            print(f"{problem.name}: ends of EECA and of native 100 at dt = {FINE:.2g} s are {apart:.2g} m apart")
    output.table(
        "Error of places against dt and time",
        [{"problem": p.problem, "stepper": p.stepper, "dt (s)": p.dt, "error (m)": p.error, "run (ms)": 1e3 * p.seconds}
         for p in points], "precision",
    )  # fmt: skip
    output.table("Slopes of the error (none where it is round-off)", slopes(points), "slopes")
    output.picture(_picture(points), "precision")


def _picture(points: list[Point]) -> Figure:
    names = list(dict.fromkeys(p.problem for p in points))
    figure = render.figure(3.0 * len(names) + 2.0, 6.0)
    axes = figure.subplots(2, len(names), sharey="col", squeeze=False)
    for column, name in enumerate(names):
        for stepper in STEPPERS:
            mine = [p for p in points if p.problem == name and p.stepper == stepper]
            error = [max(p.error, FLOOR) for p in mine]
            style = {"color": "black", "linewidth": 2.0} if stepper == EECA else {"linewidth": 1.0}
            axes[0, column].loglog([p.seconds for p in mine], error, "o-", markersize=4, label=stepper, **style)
            axes[1, column].loglog([p.dt for p in mine], error, "o-", markersize=4, **style)
        axes[0, column].set(xlabel="time of a run (s)", ylabel="error (m)", title=name)
        axes[1, column].set(xlabel="dt (s)", ylabel="error (m)")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside right upper", fontsize=8)
    return figure
