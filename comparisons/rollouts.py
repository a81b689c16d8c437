"""Rollouts: frames per second and core of many small runs, and how many of their films are wrong."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pymunk
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from pymunk import batch
from tqdm import tqdm

import eeca_pymunk as ep
from comparisons import engines
from comparisons.exact import Gas
from comparisons.hard_cases.linked import figure_on_stairs
from comparisons.output import Output, Row
from eeca_pymunk import render
from scenes import linkages

FloatArray = npt.NDArray[np.float64]
FPS = 60
FRAMES = 240
SIDE, RADIUS, SPEED = 10.0, 1.0, 3.0  # of the gases: what the settings of pymunk and Box2D are made for
WRONG = 0.25  # radii by which a ball is off in a film that is wrong
FILMS, SECONDS = 100, (1.0, 4.0)
ROUNDS = 7
ENOUGH = 0.2  # s of calls in each round
MOST = 4000  # films in a call
_POSES = batch.BodyFields.POSITION | batch.BodyFields.ANGLE | batch.BodyFields.VELOCITY


def gas(count: int, seed: int = 0) -> pymunk.Space:
    """Elastic balls in a box, without gravity."""
    start = starts(count, 1, seed)[0]
    space = pymunk.Space()
    corners = [(0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE)]
    for i, corner in enumerate(corners):
        wall = pymunk.Segment(space.static_body, corner, corners[(i + 1) % 4], 0.0)
        wall.elasticity = 1.0
        space.add(wall)
    radius = _radius(count)
    for x, y, _, vx, vy, _ in start.tolist():
        body = pymunk.Body(1.0, 0.5 * radius**2)
        body.position, body.velocity = (x, y), (vx, vy)
        ball = pymunk.Circle(body, radius)
        ball.elasticity = 1.0
        space.add(body, ball)
    return space


def _radius(count: int) -> float:
    """The same share of the box for any number."""
    return RADIUS * float(np.sqrt(5.0 / max(count, 5)))


def starts(count: int, films: int, seed: int) -> FloatArray:
    """(films, count, 6) states: on a jittered grid, clear of each other, velocities normal."""
    rng = np.random.default_rng(seed)
    columns = int(np.ceil(np.sqrt(count)))
    pitch = SIDE / columns
    found = np.zeros((films, count, 6))
    for film in found:
        cells = rng.permutation(columns * columns)[:count]
        jitter = rng.uniform(-1.0, 1.0, (count, 2)) * (0.5 * pitch - _radius(count)) * 0.999
        film[:, :2] = (np.stack((cells % columns, cells // columns), axis=1) + 0.5) * pitch + jitter
        film[:, 3:5] = SPEED * rng.normal(size=(count, 2))
    return found


def stack() -> pymunk.Space:
    """Ten boxes on a floor, with friction."""
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    floor = pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0)
    floor.friction = 0.5
    space.add(floor)
    for k in range(10):
        body = pymunk.Body(1.0, 1.0 / 6.0)
        body.position = (0.0, 0.5 + k)
        box = pymunk.Poly.create_box(body, (1.0, 1.0))
        box.friction = 0.5
        space.add(body, box)
    return space


SCENES: dict[str, Callable[[], pymunk.Space]] = {
    **{f"{n} ball{'s' if n > 1 else ''}": (lambda n=n: gas(n)) for n in (1, 2, 5, 16)},  # type: ignore[misc]
    "stack of ten boxes": stack,
    "pendulum": linkages.pendulum,
    "double pendulum": lambda: linkages.point_double(2.0, 1.0),
    "ragdoll": figure_on_stairs,
}


def poses(space: pymunk.Space) -> FloatArray:
    """(b, 6) states of the bodies that are not static."""
    bodies = [b for b in space.bodies if b.body_type != pymunk.Body.STATIC]
    return np.array([(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in bodies])


def timed(call: Callable[[], object]) -> float:
    """Seconds of a call, the mean over as many as take a while."""
    call()
    begun, calls, took = time.perf_counter(), 0, 0.0
    while calls == 0 or took < ENOUGH:
        call()
        calls, took = calls + 1, time.perf_counter() - begun
    return took / calls


def speed(name: str, build: Callable[[], pymunk.Space]) -> Row:
    """Microseconds of a frame, each way interleaved with the others, the least of some rounds."""
    space, twin, third = build(), build(), build()
    start = poses(space)
    stepper, other = ep.EECA(space), ep.EECA(third)
    states = np.repeat(start[None], 4, axis=0)
    one = timed(lambda: ep.rollout(stepper, states, FRAMES, 1.0 / FPS, threads=1)) / len(states)
    states = np.repeat(start[None], max(4, min(MOST, int(ENOUGH / one))), axis=0)
    dt, buffer, run = 1.0 / FPS, batch.Buffer(), len(states) * FRAMES
    restarts = [b for b in twin.bodies if b.body_type != pymunk.Body.STATIC]

    def back(bodies: list[pymunk.Body]) -> None:
        for body, (x, y, angle, vx, vy, spin) in zip(bodies, start.tolist(), strict=True):
            body.position, body.angle, body.velocity, body.angular_velocity = (x, y), angle, (vx, vy), spin

    def native(read: bool) -> None:
        back(restarts)
        for _ in range(FRAMES):
            twin.step(dt)
            if read:
                buffer.clear()
                batch.get_space_bodies(twin, _POSES, buffer)
                np.frombuffer(buffer.float_buf())

    def stepwise() -> None:
        other.set_state(start)
        for _ in range(FRAMES):
            other.step(dt)

    ways: dict[str, tuple[Callable[[], object], int]] = {
        "rollout": (lambda: ep.rollout(stepper, states, FRAMES, dt, threads=1), run),
        "two threads": (lambda: ep.rollout(stepper, states, FRAMES, dt, threads=2), run),
        "step": (stepwise, FRAMES),
        "space.step": (lambda: native(False), FRAMES),
        "space.step and read": (lambda: native(True), FRAMES),
    }
    least = dict.fromkeys(ways, np.inf)
    for _ in range(ROUNDS):
        for way, (call, frames) in ways.items():
            least[way] = min(least[way], 1e6 * timed(call) / frames)
    return {
        "scene": name, "bodies": len(start), **{f"{way} (us)": cost for way, cost in least.items()},
        "rollout / space.step": least["rollout"] / least["space.step"],
        "Mframes/s and core": 1.0 / least["rollout"],
        "two threads gain": least["rollout"] / least["two threads"],
    }  # fmt: skip


def calls() -> list[Row]:
    """Milliseconds of calls with five balls."""
    space = gas(5)
    stepper, start, dt = ep.EECA(space), poses(space), 1.0 / FPS
    stepper.set_state(start)

    def again() -> None:
        stepper.set_state(start)
        stepper.run(FRAMES, dt)

    ways: dict[str, Callable[[], object]] = {
        f"ep.record of {FRAMES} steps": lambda: ep.record(stepper, FRAMES * dt, dt),
        "EECA(space)": lambda: ep.EECA(space),
        f"set_state and run of {FRAMES} steps": again,
        "get_state": stepper.get_state,
        f"full rollout of {FRAMES} steps, one of 64": lambda: ep.rollout(
            stepper, np.repeat(start[None], 64, axis=0), FRAMES, dt, threads=1, full=True
        ),
    }
    return [
        {"call": name, "ms": 1e3 * min(timed(call) for _ in range(ROUNDS)) / (64 if "64" in name else 1)}
        for name, call in ways.items()
    ]


@dataclass(frozen=True)
class Films:
    """Positions (films, frames, balls, 2), and the seconds that they took."""

    positions: FloatArray
    seconds: float


def exact_films(states: FloatArray) -> FloatArray:
    """(films, frames, balls, 2) by events in time order, code that shares nothing with the package."""
    count = states.shape[1]
    found = np.zeros((len(states), FRAMES, count, 2))
    for film, state in zip(found, states, strict=True):
        balls = Gas(
            state[:, :2].copy(), state[:, 3:5].copy(), np.full(count, _radius(count)), np.ones(count), SIDE
        )  # fmt: skip
        for frame in film:
            balls.run(1.0 / FPS)
            frame[:] = balls.position
    return found


def eeca_films(states: FloatArray, substeps: int) -> Films:
    """By rollouts."""
    stepper = ep.EECA(gas(states.shape[1]))
    ep.rollout(stepper, states[:1], 1, 1.0)
    begun = time.perf_counter()
    frames = ep.rollout(stepper, states, FRAMES * substeps, 1.0 / (FPS * substeps), substeps, threads=1)
    return Films(frames[..., :2], time.perf_counter() - begun)


def pymunk_films(states: FloatArray, substeps: int) -> Films:
    """By pymunk's own steps."""
    found, seconds = np.zeros((len(states), FRAMES, states.shape[1], 2)), 0.0
    for film, state in zip(found, states, strict=True):
        space = gas(states.shape[1])
        for body, (x, y, _, vx, vy, _) in zip(space.bodies, state.tolist(), strict=True):
            body.position, body.velocity = (x, y), (vx, vy)
        begun, buffer = time.perf_counter(), batch.Buffer()
        for frame in film:
            for _ in range(substeps):
                space.step(1.0 / (FPS * substeps))
            buffer.clear()
            batch.get_space_bodies(space, batch.BodyFields.POSITION, buffer)
            frame[:] = np.frombuffer(buffer.float_buf()).reshape(-1, 2)[: len(frame)]
        seconds += time.perf_counter() - begun
    return Films(found, seconds)


def box2d_films(states: FloatArray, substeps: int) -> Films | str:
    """By Box2D, in a process of its own (`comparisons.engines`); or why there are none."""
    count, radius = states.shape[1], _radius(states.shape[1])
    job = {
        "gravity": 0.0, "friction": 0.0, "elasticity": 1.0, "rod": False, "radius": [radius] * count,
        "moment": [0.5 * radius**2] * count, "dt": 1.0 / (FPS * substeps), "steps": FRAMES * substeps,
        "walls": [[0, 0, SIDE, 0], [SIDE, 0, SIDE, SIDE], [SIDE, SIDE, 0, SIDE], [0, SIDE, 0, 0]], "every": substeps,
    }  # fmt: skip
    made = engines.films(job, [{"start": state.tolist()} for state in states])
    if isinstance(made, str):
        return made
    return Films(np.array([one.states[:, :, :2] for one in made]), sum(one.seconds for one in made))


def wrong(films: Films, exact: FloatArray) -> Row:
    """The share of films in which some ball is off after each of SECONDS, and what they cost."""
    off = np.linalg.norm(films.positions - exact, axis=3).max(axis=2) > WRONG * _radius(exact.shape[2])
    ever = np.maximum.accumulate(off, axis=1)
    return {
        **{f"wrong after {s:g} s": float(ever[:, round(s * FPS) - 1].mean()) for s in SECONDS},
        "frames/s": films.positions.shape[0] * FRAMES / films.seconds,
    }


def errors(full: bool) -> list[Row]:
    """Films of five balls."""
    states = starts(5, FILMS, 1)
    exact = exact_films(states)
    ways: list[tuple[str, Callable[[FloatArray, int], Films | str], tuple[int, ...]]] = [
        ("EECA", eeca_films, (1,)),
        ("pymunk", pymunk_films, (1, 4, 16, 64) if full else (1, 4, 16)),
        ("Box2D", box2d_films, (1, 4, 16)),
    ]
    rows: list[Row] = []
    jobs = [(name, make, n) for name, make, several in ways for n in several]
    for name, make, substeps in tqdm(jobs, desc="films", unit="kind", disable=None):
        films = make(states, substeps)
        if isinstance(films, str):
            print(f"# no films of {name}: {films}")
            continue
        rows.append({"engine": name, "steps/s": FPS * substeps, **wrong(films, exact)})
    return rows


def picture(rows: list[Row]) -> Figure:
    """Share of wrong films over frames per second: a colour for each engine, a marker for each step size."""
    figure = render.figure(9.0, 4.2)
    engines = list(dict.fromkeys(row["engine"] for row in rows))
    marks = dict(zip(sorted({int(row["steps/s"] or 0) for row in rows}), "os^vD", strict=False))
    for ax, seconds in zip(figure.subplots(1, 2, sharey=True), SECONDS, strict=True):
        for i, name in enumerate(engines):
            own = [row for row in rows if row["engine"] == name]
            speeds, shares = [row["frames/s"] for row in own], [row[f"wrong after {seconds:g} s"] for row in own]
            ax.semilogx(speeds, shares, color=f"C{i}")
            for row, x, y in zip(own, speeds, shares, strict=True):
                ax.plot(x, y, marks[int(row["steps/s"] or 0)], color=f"C{i}", alpha=0.8)
        ax.set(xlabel="frames per second, one core", title=f"after {seconds:g} s", ylim=(-0.06, 1.06))
        if seconds == SECONDS[0]:
            ax.set_ylabel("share of films that are wrong")
    told = [Line2D([], [], color=f"C{i}", label=str(name)) for i, name in enumerate(engines)]
    told += [Line2D([], [], color="black", ls="", marker=m, label=f"dt = 1/{n} s") for n, m in marks.items()]
    figure.legend(handles=told, loc="outside lower center", ncol=len(told), fontsize=8)
    figure.suptitle(f"{FILMS} films of five elastic balls: wrong once a ball is off by a quarter of its radius")
    return figure


def run(output: Output, full: bool) -> None:
    """Print the tables; write CSV and PNG."""
    output.parameters({"frames/s": FPS, "frames": FRAMES, "dt": f"1/{FPS}", "rounds": ROUNDS})
    ep.warmup()
    rows = [speed(name, build) for name, build in tqdm(SCENES.items(), desc="speed", unit="scene", disable=None)]
    output.table("Microseconds of a frame, one step each; pymunk from Python", rows)
    output.table("Calls with five balls", calls(), "calls")
    films = errors(full)
    output.table(f"{FILMS} films of five balls: the share that is wrong", films, "films")
    output.picture(picture(films), "films")
