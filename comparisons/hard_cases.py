"""Hard cases: kinds of trouble that users of engines report, each with its own oracle; a matrix of passes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pymunk
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from tqdm import tqdm

import eeca_pymunk as ep
import scenes
from comparisons import runs
from comparisons.hopper import crossed
from comparisons.output import Output, Row, as_text
from comparisons.pool_break import asymmetry
from eeca_pymunk import render
from scenes.scene import add_disk, add_walls

DT, G = 1 / 60, 9.81
LONG = {"crowd": 20_000, "720-gon": 15_000}  # steps of the longest cases
Measure = Callable[[runs.Make], float]


@dataclass(frozen=True)
class Case:
    """A kind of trouble: what its figure is, the largest that passes, and how to get it under a stepper."""

    name: str
    figure: str
    limit: float
    run: Measure


CASES: list[Case] = []


def case(name: str, figure: str, limit: float) -> Callable[[Measure], Measure]:
    """Make a function that runs a scene under a stepper, and returns its figure, a case."""

    def enter(run: Measure) -> Measure:
        CASES.append(Case(name, figure, limit, run))
        return run

    return enter


def go(space: pymunk.Space, make: runs.Make, steps: int, dt: float = DT) -> ep.Stepper:
    """Take so many steps."""
    stepper = make(space)
    for _ in range(steps):
        stepper.step(dt)
    return stepper


def apexes(e: float, make: runs.Make, height: float, radius: float, floor: float, dt: float, bounces: int) -> float:
    """Height of the apex after so many bounces of a disk that starts `height` above the floor's zero."""
    space = pymunk.Space()
    space.gravity = (0.0, -G)
    ball = add_disk(space, (0.0, height), radius)
    add_walls(space, [((-9.0, floor), (9.0, floor))])
    next(iter(ball.shapes)).elasticity = e
    # Till the middle of the flight after the last bounce.
    fall = math.sqrt(2.0 * (height - radius - floor) / G)
    flights = sum(2.0 * e**k * fall for k in range(1, bounces + 1)) - e**bounces * fall
    go(space, make, max(round((fall + flights) / dt), math.ceil(fall / dt) + 5), dt)
    return float(ball.position.y + 0.5 * ball.velocity.y**2 / G)


@case("bounce height, 100 bounces", "apex off (m)", 1e-9)
def bounce_height(make: runs.Make) -> float:
    return abs(apexes(1.0, make, 2.3, 0.2, 0.1, DT, 100) - 2.3)


@case("restitution 0 to .95", "apex ratio off e²", 1e-9)
def restitution(make: runs.Make) -> float:
    rise = {e: apexes(e, make, 2.3, 0.2, 0.1, DT, 1) - 0.3 for e in (0.0, 0.3, 0.5, 0.8, 0.95)}
    return max(abs(high / 2.0 - e * e) for e, high in rise.items())


@case("high drop, 50 bounces", "apex off (m)", 1e-9)
def high_drop(make: runs.Make) -> float:
    return abs(apexes(1.0, make, 10.0, 0.5, 0.0, 1 / 240, 50) - 10.0)


@case("slow ball, v = 1 to 1e-4", "speed off (relative)", 1e-12)
def slow_ball(make: runs.Make) -> float:
    worst = 0.0
    for v in (1.0, 0.1, 0.01, 1e-4):
        space = pymunk.Space()
        ball = add_disk(space, (-0.5 - 10.3 * v * DT, 0.0), 0.5, velocity=(v, 0.0))
        add_walls(space, [((0.0, -2.0), (0.0, 2.0))])
        go(space, make, 30)
        worst = max(worst, abs(ball.velocity.x / v + 1.0))
    return worst


@case("swap of velocities", "velocity off", 1e-12)
def swap(make: runs.Make) -> float:
    space = pymunk.Space()
    a, b = add_disk(space, (0.0, 0.0), 0.5, 10.0, (1.0, 0.0)), add_disk(space, (1.3, 0.0), 0.5, 10.0)
    go(space, make, 60)
    return abs(a.velocity.x) + abs(b.velocity.x - 1.0)


@case("touching line of three", "off (-2/3, 4/3, 4/3)", 1e-9)
def touching_line(make: runs.Make) -> float:
    space = pymunk.Space()
    line = [add_disk(space, (float(x), 0.0), 0.5, velocity=(2.0 * (x == 0), 0.0)) for x in range(3)]
    go(space, make, 1)
    return float(np.abs([b.velocity.x - v for b, v in zip(line, (-2 / 3, 4 / 3, 4 / 3), strict=True)]).max())


@case("Bernoulli: one onto two", "velocity off", 1e-9)
def bernoulli(make: runs.Make) -> float:
    space = pymunk.Space()
    a = add_disk(space, (-math.sqrt(0.75) - 0.1, 0.0), 0.5, velocity=(2.0, 0.0))
    b, c = add_disk(space, (0.0, 0.5), 0.5), add_disk(space, (0.0, -0.5), 0.5)
    go(space, make, 12)
    v = np.array([x.velocity for x in (a, b, c)])
    y = 1.2 / math.sqrt(3.0)
    return float(np.abs(v - [(-0.4, 0.0), (1.2, y), (1.2, -y)]).max())


@case("break of 55 disks", "energy, momentum, symmetry at 6 ms off", 1e-9)
def pool_break(make: runs.Make) -> float:
    scene = scenes.build("pool_break")
    stepper = go(scene.space, make, 24, scene.dt)
    asymmetric = asymmetry(scene)
    for _ in range(176):
        stepper.step(scene.dt)
    now = ep.measure(scene.space)
    momentum = float(np.abs(now.linear_momentum - (0.0, 1.5)).max())
    return max(abs(now.energy / 7.5 - 1.0), momentum, asymmetric)


@case("nearly parallel contacts, 720-gon", "energy off (relative)", 1e-9)
def parallel_contacts(make: runs.Make) -> float:
    space = pymunk.Space()
    add_disk(space, (0.0, 0.5), 1.0, velocity=(1.0, 0.3))
    angle = np.linspace(0.0, 2.0 * math.pi, 721)
    rim = [(4.0 * math.cos(a), 4.0 * math.sin(a)) for a in angle]
    add_walls(space, pairwise(rim))
    stepper, worst = make(space), 0.0
    for _ in range(LONG["720-gon"]):
        stepper.step(0.01)
        worst = max(worst, abs(ep.measure(space).energy / 0.545 - 1.0))
    return worst


@case("seam of two segments", "energy off (relative)", 1e-12)
def seam(make: runs.Make) -> float:
    space = pymunk.Space()
    tilt = math.tan(math.radians(0.25))
    add_walls(space, [((-3.0, 3.0 * tilt), (0.0, 0.0)), ((0.0, 0.0), (3.0, 3.0 * tilt))])
    add_disk(space, (-1.5 * math.sqrt(3.0), 2.0), 0.5, velocity=(math.sqrt(3.0), -1.0))
    go(space, make, 150)
    return abs(ep.measure(space).kinetic / 2.0 - 1.0)


def pi_hits(make: runs.Make, mass: float, dt: float) -> int:
    """Hits of two balls, one of which runs against a wall; a mass ratio of 100^n tells n + 1 digits of pi."""
    space = pymunk.Space()
    small = add_disk(space, (2.0, 0.0), 0.1)
    add_disk(space, (4.0, 0.0), 0.5, mass, (-1.0, 0.0))
    add_walls(space, [((0.0, -1.0), (0.0, 1.0))])
    stepper, hits, before = make(space), 0, small.velocity.x
    for _ in range(round(20.0 / dt)):
        report = stepper.step(dt)
        # Native does not tell its contacts: a step in which the velocity changes is a hit.
        hits += int((report.impulse > 1e-12).sum()) if len(report.impulse) else int(small.velocity.x != before)
        before = small.velocity.x
    return hits


@case("pi, mass ratio 1e4", "hits off 314", 0.0)
def pi_blocks(make: runs.Make) -> float:
    return abs(pi_hits(make, 1e4, 1e-3) - 314)


@case("pi, mass ratio 1e6", "hits off 3141", 0.0)
def pi_blocks_heavy(make: runs.Make) -> float:
    return abs(pi_hits(make, 1e6, 1e-3) - 3141)


@case("tunnelling, v = 5 to 1000", "passed through", 0.0)
def tunnelling(make: runs.Make) -> float:
    passed = 0
    for v in (5.0, 23.0, 50.0, 400.0, 1000.0):
        space = pymunk.Space()
        disk = add_disk(space, (-2.0, 0.0), 0.2, velocity=(v, 0.0))
        add_walls(space, [((0.0, -2.0), (0.0, 2.0))])
        go(space, make, math.ceil(3.0 / (v * DT)))
        passed += disk.velocity.x > 0.0 or disk.position.x > 0.0
    return passed


@case("grazing hits, 1e-9 deep", "missed", 0.0)
def grazing(make: runs.Make) -> float:
    missed = 0
    for depth in (1e-3, 1e-6, 1e-9):
        space = pymunk.Space()
        add_disk(space, (-2.03, 0.0), 0.5, velocity=(3.0, 0.0))
        other = add_disk(space, (0.0, 1.0 - depth), 0.5)
        go(space, make, 80)
        missed += other.velocity.length == 0.0
    return missed


@case("corners of 90°, 60° and 120°", "velocity not reversed", 1e-6)
def corner(make: runs.Make) -> float:
    worst = 0.0
    for degrees in (90.0, 60.0, 120.0):
        # Off the middle of 120°, which does not divide 180°, exact mechanics does not reverse it: two hits, not one.
        for offset in (0.0, 1e-9, 1e-3) if degrees < 120.0 else (0.0,):
            space = pymunk.Space()
            half = math.radians(degrees / 2.0)
            ends = [(4.0 * math.cos(half), s * 4.0 * math.sin(half)) for s in (1.0, -1.0)]
            add_walls(space, [((0.0, 0.0), end) for end in ends])
            disk = add_disk(space, (2.5, offset), 0.2, velocity=(-1.0, 0.0))
            go(space, make, 240)
            worst = max(worst, float(np.hypot(disk.velocity.x - 1.0, disk.velocity.y)))
    return worst


@case("overlap at the start", "kinetic energy gained", 0.0)
def overlap(make: runs.Make) -> float:
    gained = 0.0
    for distance in (0.9, 0.5, 0.1, 0.0):
        space = pymunk.Space()
        add_disk(space, (0.0, 0.0), 0.5)
        add_disk(space, (distance, 0.0), 0.5)
        go(space, make, 60)
        gained = max(gained, ep.measure(space).kinetic)
    return gained


@case("resting ball, elastic", "moved (m)", 1e-9)
def resting(make: runs.Make) -> float:
    space = pymunk.Space()
    space.gravity = (0.0, -G)
    ball = add_disk(space, (0.0, 0.5), 0.5)
    add_walls(space, [((-9.0, 0.0), (9.0, 0.0))])
    stepper, worst = make(space), 0.0
    for _ in range(600):
        stepper.step(DT)
        worst = max(worst, abs(ball.position.y - 0.5))
    return worst


@case("stack of five boxes", "moved (m)", 1e-9)
def stack(make: runs.Make) -> float:
    space = pymunk.Space()
    space.gravity = (0.0, -G)
    add_walls(space, [((-9.0, 0.0), (9.0, 0.0))])
    boxes = []
    for k in range(5):
        body = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (1.0, 1.0)))
        body.position = (0.0, 0.5 + k)
        space.add(body, pymunk.Poly.create_box(body, (1.0, 1.0)))
        boxes.append(body)
    go(space, make, 300)
    return float(max(np.hypot(b.position.x, b.position.y - 0.5 - k) for k, b in enumerate(boxes)))


@case("rod onto its corner", "velocity and spin off", 1e-6)
def rod(make: runs.Make) -> float:
    space = pymunk.Space()
    add_walls(space, [((-9.0, 0.0), (9.0, 0.0))])
    body = pymunk.Body(1.0, (2.0**2 + 0.1**2) / 12.0)
    body.position, body.angle, body.velocity = (0.0, 1.0), math.radians(30.0), (0.0, -1.0)
    box = pymunk.Poly.create_box(body, (2.0, 0.1))
    box.elasticity = 1.0
    space.add(body, box)
    stepper = make(space)
    for _ in range(60):
        stepper.step(DT)
        if body.velocity.y != -1.0:
            break
    return max(abs(body.velocity.y + 0.35829141), abs(abs(body.angular_velocity) - 1.61504207))


@case("mixed shapes, 10 s", "energy off, or outside", 1e-11)
def mixed(make: runs.Make) -> float:
    scene = scenes.build("mixed")
    go(scene.space, make, 600)
    x = np.array([b.position for b in scene.bodies])
    return (
        math.inf
        if (x < 0.0).any() or (x > 4.0).any()
        else abs(ep.measure(scene.space).energy / ep.measure(scenes.build("mixed").space).energy - 1.0)
    )


@case("crowd of 100 disks, 20 000 steps", "energy off, or outside", 1e-11)
def crowd(make: runs.Make) -> float:
    rng = np.random.default_rng(0)
    space = pymunk.Space()
    for k in range(100):
        vx, vy = rng.normal(scale=3.0, size=2)
        add_disk(space, (1.0 + 2.0 * (k % 10), 1.0 + 2.0 * (k // 10)), 0.4, velocity=(float(vx), float(vy)))
    corners = [(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)]
    add_walls(space, list(zip(corners, corners[1:] + corners[:1], strict=True)))
    start = ep.measure(space).energy
    go(space, make, LONG["crowd"])
    x = np.array([b.position for b in space.bodies])
    return math.inf if (x < 0.0).any() or (x > 20.0).any() else abs(ep.measure(space).energy / start - 1.0)


@case("inelastic collapse, e = .1", "energy rise, or not finite", 1e-12)
def collapse(make: runs.Make) -> float:
    space = pymunk.Space()
    line = [add_disk(space, (1.5 * k, 0.0), 0.5, velocity=(2.0, 0.0)) for k in range(5)]
    add_walls(space, [((7.0, -2.0), (7.0, 2.0))])
    for shape in space.shapes:
        shape.elasticity = math.sqrt(0.1)
    stepper, energy = make(space), [ep.measure(space).energy]
    for _ in range(300):
        stepper.step(DT)
        energy.append(ep.measure(space).energy)
    rise = max(0.0, float(np.diff(energy).max()))
    return rise if all(math.isfinite(b.position.x) for b in line) else math.inf


@case("kinematic plates that squeeze", "not finite, or a plate moved off", 1e-9)
def squeeze(make: runs.Make) -> float:
    space = pymunk.Space()
    plates = []
    for side in (-1.0, 1.0):
        plate = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        plate.position, plate.velocity = (side * 1.0, 0.0), (-side * 1.0, 0.0)
        face = pymunk.Segment(plate, (0.0, -2.0), (0.0, 2.0), 0.0)
        face.elasticity = 1.0
        space.add(plate, face)
        plates.append(plate)
    disk = add_disk(space, (0.1, 0.0), 0.3, velocity=(1.0, 0.0))
    go(space, make, 45)
    off = max(abs(p.position.x - s * (1.0 - 45 * DT)) for p, s in zip(plates, (-1.0, 1.0), strict=True))
    return off if math.isfinite(disk.position.x) and math.isfinite(disk.velocity.x) else math.inf


@case("units from 1e-3 to 1e4 m", "paths differ (relative)", 1e-9)
def scales(make: runs.Make) -> float:
    ends = []
    for unit in (1.0, 1e-3, 1e4):
        space = pymunk.Space()
        space.gravity = (0.0, -G * unit)
        for k in range(4):
            add_disk(
                space, ((0.3 + 0.7 * k) * unit, (1.0 + 0.1 * k) * unit), 0.2 * unit, velocity=(unit * (1 - k), 0.0)
            )
        corners = [(0.0, 0.0), (3.0 * unit, 0.0), (3.0 * unit, 3.0 * unit), (0.0, 3.0 * unit)]
        add_walls(space, list(zip(corners, corners[1:] + corners[:1], strict=True)))
        go(space, make, 60)
        ends.append(np.array([b.position for b in space.bodies]) / unit)
    return float(max(np.abs(end - ends[0]).max() for end in ends))


@case("dt from 3e-5 to 1/10", "paths differ (m)", 1e-9)
def steps(make: runs.Make) -> float:
    ends = []
    for dt in (1 / 15, 1 / 60, 1e-5 * 10 / 3):
        scene = scenes.build("gas", seed=3)
        go(scene.space, make, round(0.1 / dt) if dt < 0.05 else 1, dt if dt < 0.05 else 0.1)
        ends.append(np.array([b.position for b in scene.bodies]))
    return float(max(np.abs(end - ends[0]).max() for end in ends))


@case("thousand contacts on one body", "momentum and energy off", 1e-9)
def thousand(make: runs.Make) -> float:
    space = pymunk.Space()
    big = add_disk(space, (0.0, 0.0), 10.0, 100.0, (1.0, 0.0))
    for a in np.linspace(0.0, 2.0 * math.pi, 1000, endpoint=False):
        add_disk(space, (10.03 * math.cos(a), 10.03 * math.sin(a)), 0.03, 0.01)
    go(space, make, 5)
    now = ep.measure(space)
    momentum = float(now.linear_momentum[0])
    return max(abs(now.energy / 50.0 - 1.0), abs(momentum / 100.0 - 1.0), abs(big.position.y))


@case("bad input", "accepted", 0.0)
def guards(make: runs.Make) -> float:
    accepted = 0
    for spoil in ("dt < 0", "dt nan", "velocity nan", "position inf", "mass 0"):
        space = pymunk.Space()
        body = add_disk(space, (0.0, 0.0), 0.5)
        dt = {"dt < 0": -DT, "dt nan": math.nan}.get(spoil, DT)
        try:
            if spoil == "velocity nan":
                body.velocity = (math.nan, 0.0)
            elif spoil == "position inf":
                body.position = (math.inf, 0.0)
            elif spoil == "mass 0":
                bare = pymunk.Body()
                space.add(bare, pymunk.Circle(bare, 0.1))
            make(space).step(dt)
            accepted += 1
        except (ValueError, AssertionError):
            pass
    return accepted


@case("twins: twice, and in another order", "paths differ (m)", 1e-9)
def twins(make: runs.Make) -> float:
    ends = []
    for order in (1, 1, -1):
        space = pymunk.Space()
        rng = np.random.default_rng(5)
        things = [
            (float(x), float(y), *map(float, rng.normal(size=2))) for x in (0.5, 1.5, 2.5) for y in (0.5, 1.5, 2.5)
        ]
        for x, y, u, v in things[::order]:
            add_disk(space, (x, y), 0.3, velocity=(u, v))
        corners = [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (0.0, 3.0)]
        add_walls(space, list(zip(corners, corners[1:] + corners[:1], strict=True)))
        go(space, make, 60)
        ends.append(np.array([b.position for b in space.bodies])[::order])
    return math.inf if (ends[0] != ends[1]).any() else float(np.abs(ends[2] - ends[0]).max())


@case("hopper, dt = .0025, .5 s", "energy off, or leaked", 1e-11)
def hopper(make: runs.Make) -> float:
    scene = scenes.build("hopper")
    stepper, start = make(scene.space), ep.measure(scene.space).energy
    leaked, x = 0, np.array([b.position for b in scene.bodies])
    for _ in range(200):
        stepper.step(scene.dt)
        before, x = x, np.array([b.position for b in scene.bodies])
        leaked += int(crossed(before, x).sum())
    return float(leaked) if leaked else abs(ep.measure(scene.space).energy / start - 1.0)


def columns() -> dict[str, runs.Make]:
    """The steppers of the matrix."""

    def hundred(space: pymunk.Space) -> ep.Stepper:
        space.iterations = 100
        return ep.Native(space)

    return {
        "TimeOfImpact": runs.eeca(ep.TimeOfImpact()),
        "Midstep": runs.eeca(ep.Midstep()),
        "Dashpot": runs.eeca(ep.Dashpot(1e6, 200.0)),
        "native 10": runs.native(),
        "native 100": hundred,
    }


def figure(one: Case, make: runs.Make) -> float | None:
    """The figure of a case; None where the stepper refuses the scene, infinity where it gives up."""
    try:
        return float(one.run(make))
    except ep.UnsupportedFeature:
        return None
    except (ValueError, ArithmeticError):
        return math.inf


def run(output: Output, full: bool) -> None:
    """Print the matrix; write CSV and PNG."""
    makes = columns()
    output.parameters({"dt": "1/60 unless said", "Dashpot": "K = 1e6, xi = 200", "native": "slop .1, persistence 3"})
    rows: list[Row] = []
    for one in tqdm(CASES, desc="hard cases", unit="case"):
        found = {name: figure(one, make) for name, make in makes.items()}
        row: dict[str, str | float] = {"case": one.name, "figure": one.figure, "passes up to": one.limit}
        for name, value in found.items():
            row[name] = "refused" if value is None else f"{'pass' if value <= one.limit else 'FAIL'} {as_text(value)}"
        rows.append(row)
    output.table("Hard cases: each cell the measured figure", rows)
    passed = {name: sum(str(r[name]).startswith("pass") for r in rows) for name in makes}
    print(f"passed of {len(rows)}: " + ", ".join(f"{name} {count}" for name, count in passed.items()))
    output.picture(_matrix(rows, list(makes)))


def _matrix(rows: list[Row], names: list[str]) -> Figure:
    picture = render.figure(9.5, 0.3 * len(rows) + 1.0)
    ax = picture.add_subplot()
    shades = {"pass": to_rgb("#56b4e9"), "FAIL": to_rgb("#d55e00"), "refused": to_rgb("#dddddd")}
    cells = [[str(row[name]).split() for name in names] for row in rows]
    ax.imshow([[shades[c[0]] for c in line] for line in cells], aspect="auto")
    for i, line in enumerate(cells):
        for j, c in enumerate(line):
            ax.text(j, i, " ".join(c), ha="center", va="center", fontsize=8)
    ax.set_xticks(range(len(names)), names)
    ax.set_yticks(range(len(rows)), [str(row["case"]) for row in rows])
    ax.xaxis.tick_top()
    return picture
