"""What six public games and lessons use of pymunk, in scenes of our own: see docs/programs.md."""

from __future__ import annotations

import math
from collections.abc import Callable

import pymunk
import pytest
from pymunk import Vec2d

import eeca_pymunk as ep
from comparisons.program_scenes import push_t

Make = Callable[[pymunk.Space], ep.Stepper]
both = pytest.mark.parametrize("make", [ep.Native, ep.EECA])
OURS: Make = ep.EECA


@both
def test_a_hero_falls_no_faster_than_told_and_rides_a_platform(make: Make) -> None:
    """arcade's PymunkPhysicsEngine: a velocity function that clamps both components, a hero who cannot turn, a
    kinematic platform, and `each_arbiter` with normals to tell on whom the hero stands."""
    space, dt = pymunk.Space(), 1 / 60
    space.gravity = (0.0, -1500.0)
    platform, hero = pymunk.Body(body_type=pymunk.Body.KINEMATIC), pymunk.Body(2.0, math.inf)
    platform.position, platform.velocity, hero.position = (500.0, 0.0), (60.0, 0.0), (500.0, 500.0)
    deck, boots = pymunk.Poly.create_box(platform, (200.0, 20.0)), pymunk.Poly.create_box(hero, (40.0, 60.0))
    deck.friction = boots.friction = 1.0
    space.add(platform, deck, hero, boots)

    def clamped(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
        pymunk.Body.update_velocity(body, gravity, damping, dt)
        x, y = body.velocity
        body.velocity = (math.copysign(min(abs(x), 450.0), x), math.copysign(min(abs(y), 600.0), y))

    hero.velocity_func = clamped
    stepper, fastest, landed = make(space), 0.0, -1

    def ground() -> list[pymunk.Body]:
        found: list[pymunk.Body] = []

        def look(arbiter: pymunk.Arbiter) -> None:
            if arbiter.contact_point_set.normal.y < -0.7:
                found.append(arbiter.shapes[1].body)

        hero.each_arbiter(look)
        return found

    for k in range(120):
        stepper.step(dt)
        fastest = max(fastest, -hero.velocity.y)
        if landed < 0 and ground():
            landed = k
    assert fastest == 600.0
    # 500 to 40: .4 s to 600 on the way of 120, then 340 at 600.
    assert landed * dt == pytest.approx(0.4 + 340.0 / 600.0, abs=2.5 * dt)
    assert ground() == [platform]
    assert hero.velocity == pytest.approx((60.0, 0.0), abs=1e-6)
    before = hero.position - platform.position
    for _ in range(60):
        stepper.step(dt)
    assert hero.position - platform.position == pytest.approx(tuple(before), abs=0.15)
    for _ in range(30):
        hero.apply_force_at_local_point((8000.0, 0.0))
        stepper.step(dt)
    assert hero.velocity.x == pytest.approx(min(450.0, 60.0 + (8000.0 - 3000.0) / 2.0 * 0.5), abs=26.0)


@both
def test_a_ball_rolls_into_a_basket_and_rests_in_its_goal(make: Make) -> None:
    """tool-games: compounds of polygons made before they have a body, a sensor for a goal, logs of who meets whom by
    `begin` and `separate`, sleeping; and the same pairs meet first in the same order under both."""
    space, names = pymunk.Space(), dict[pymunk.Shape, str]()
    space.gravity, space.sleep_time_threshold = (0.0, -200.0), 1.0

    def add(shape: pymunk.Shape, name: str) -> None:
        shape.collision_type, shape.elasticity, shape.friction, names[shape] = 1, 0.5, 0.5, name
        space.add(shape)

    add(pymunk.Poly(space.static_body, [(0, 300), (0, 320), (200, 240), (200, 220)]), "slope")
    add(pymunk.Poly(space.static_body, [(-1, -1), (-1, 1), (601, 1), (601, -1)]), "floor")
    basket, ball = pymunk.Body(5.0, 10000.0), pymunk.Body(3.0, pymunk.moment_for_circle(3.0, 0.0, 15.0))
    basket.position, ball.position = (360.0, 9.0), (30.0, 350.0)
    space.add(basket, ball)
    walls = [(-60, -8, 60, 0), (-60, 0, -52, 90), (52, 0, 60, 90)]
    for x0, y0, x1, y1 in walls:
        part = pymunk.Poly(None, [(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
        part.body = basket
        add(part, "basket")
    add(pymunk.Circle(ball, 15.0), "ball")
    goal = pymunk.Poly(basket, [(-52, 0), (52, 0), (52, 90), (-52, 90)])
    goal.sensor, goal.collision_type = True, 2
    space.add(goal)
    met: dict[tuple[str, ...], float] = {}
    inside: list[float] = []
    now = [0.0]

    def meet(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        met.setdefault(tuple(sorted(names[s] for s in arbiter.shapes)), now[0])

    space.on_collision(1, 1, begin=meet, separate=lambda *_: None)
    space.on_collision(1, 2, begin=lambda *_: inside.append(now[0]), separate=lambda *_: inside.append(-1.0))
    stepper = make(space)
    for k in range(1000):
        now[0] = 0.01 * k
        stepper.step(0.01)
    assert list(met) == [("basket", "floor"), ("ball", "slope"), ("ball", "basket")]
    # A fall through 350 - (308 + 15 / cos) to the slope, of 200.
    fall = 350.0 - (308.0 + 15.0 * math.hypot(1.0, 0.4))
    assert met["ball", "slope"] == pytest.approx(math.sqrt(2.0 * fall / 200.0), abs=0.03)
    assert inside == [pytest.approx(3.75, abs=0.05)]
    assert goal.point_query(ball.position).distance < 0.0
    # Slowness is not rest: ours still rolls by .05 mm/s, and native sleeps.
    assert (ball.velocity.length < 1e-4, basket.velocity.length < 1e-9) == (True, True)
    assert make is OURS or (ball.is_sleeping and basket.is_sleeping)
    assert ball.position.y - basket.position.y == pytest.approx(15.0, abs=0.11)


def ball_of_pool(space: pymunk.Space, x: float) -> pymunk.Body:
    """A ball whose rolling resistance is a pivot to the table, of bounded force."""
    body = pymunk.Body()
    body.position = (x, 300.0)
    shape = pymunk.Circle(body, 18.0)
    shape.mass, shape.elasticity = 4.0, 0.85
    pivot = pymunk.PivotJoint(space.static_body, body, (0, 0), (0, 0))
    pivot.max_bias, pivot.max_force = 0.0, 400.0
    space.add(body, shape, pivot)
    return body


@both
def test_a_ball_rolls_as_far_as_its_resistance_says(make: Make) -> None:
    """Billiards-PyMunk: v²/2a of a = 100 from 200; native is half a step's way off."""
    space = pymunk.Space()
    ball = ball_of_pool(space, 0.0)
    stepper = make(space)
    ball.apply_impulse_at_local_point((800.0, 0.0))
    for _ in range(300):
        stepper.step(1 / 120)
    assert ball.position.x == pytest.approx(200.0, abs=1e-9 if make is OURS else 1.0)
    assert ball.velocity.length == pytest.approx(0.0, abs=1e-9)


@both
def test_a_ball_whose_body_alone_was_removed_stands_like_a_wall(make: Make) -> None:
    """Billiards-PyMunk again: potted balls lose their body, and leave shape and pivot in the space."""
    space = pymunk.Space()
    cue, potted = ball_of_pool(space, 100.0), ball_of_pool(space, 200.0)
    stepper = make(space)
    stepper.step(1 / 120)
    space.remove(potted)
    assert (len(space.bodies), len(space.shapes), len(space.constraints)) == (1, 2, 2)
    cue.apply_impulse_at_local_point((800.0, 0.0))
    for _ in range(240):
        stepper.step(1 / 120)
    assert potted.position == (200.0, 300.0)
    # 64 to the ball's face; from there, native's ball gives its momentum to one that stays, ours comes back.
    face = 164.0
    left = math.sqrt(200.0**2 - 2.0 * 100.0 * 64.0) * 0.85**2
    assert cue.position.x == pytest.approx(face - left**2 / 200.0 if make is OURS else face, abs=3.0)
    space.add(potted)
    cue.position, cue.velocity = (150.0, 300.0), (100.0, 0.0)
    for _ in range(60):
        stepper.step(1 / 120)
    assert potted.position.x > 200.0


@both
def test_a_ball_over_a_hole_and_through_ghosts_stops_where_it_should(make: Make) -> None:
    """minigolf-sim: `begin` handlers that let a ball over the hole and through twenty ghosts that start all at its
    place, a function that limits its speed, `velocity *= .99` after each step, and an obstacle of mass 1e20."""
    space, dt = pymunk.Space(), 1 / 60
    ball, rock = pymunk.Body(1.0, 50.0), pymunk.Body(1e20, 1e22)
    ball.position, rock.position = (150.0, 200.0), (620.0, 200.0)

    def limited(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
        pymunk.Body.update_velocity(body, gravity, damping, dt)
        if body.velocity.length > 500.0:
            body.velocity *= 500.0 / body.velocity.length

    ball.velocity_func = limited
    hole = pymunk.Circle(space.static_body, 15.0, (500.0, 200.0))
    skin, stone = pymunk.Circle(ball, 10.0), pymunk.Poly.create_box(rock, (50.0, 50.0))
    for shape, kind in ((skin, 4), (hole, 9), (stone, 2)):
        shape.collision_type, shape.elasticity, shape.friction = kind, 0.7, 0.5
    space.add(ball, skin, hole, rock, stone)
    for k in range(20):
        ghost = pymunk.Body(1.0, 50.0)
        ghost.position, ghost.velocity = ball.position, Vec2d(400.0, 0.0).rotated(2.0 * math.pi * (k + 0.5) / 20.0)
        space.add(ghost, pymunk.Circle(ghost, 10.0))
        next(iter(ghost.shapes)).collision_type = 5

    def ignore(arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        arbiter.process_collision = False

    for pair in ((4, 9), (4, 5), (5, 5), (5, 9), (2, 5)):
        space.on_collision(*pair, begin=ignore)
    stepper = make(space)
    ball.velocity = (400.0, 0.0)
    x, v = 150.0, 400.0
    for _ in range(300):
        stepper.step(dt)
        ball.velocity *= 0.99
        # The same on paper: the face of the rock is at 595.
        ahead = x + v * dt
        if ahead > 585.0:
            ahead, v = 585.0 - 0.49 * (ahead - 585.0), -0.49 * v
        x, v = ahead, 0.99 * v
        assert ball.velocity.length <= 500.0
    assert ball.position == pytest.approx((x, 200.0), abs=1e-9 if make is OURS else 5.0)
    assert rock.position == pytest.approx((620.0, 200.0), abs=1e-12)
    for ghost in space.bodies:
        if ghost not in (ball, rock):
            assert (ghost.position - (150.0, 200.0)).length == pytest.approx(400.0 * 5.0)


@both
def test_a_cloth_keeps_its_threads_and_comes_back_when_it_is_made_anew(make: Make) -> None:
    """cloth_simulation: pins to static bodies that are not in the space, masses by density, an impulse on every node,
    and `space.remove` of all at once, after which the same cloth is made again."""
    space, ends, longest = pymunk.Space(), [], 0.0
    space.gravity = (0.0, -800.0)
    stepper = make(space)
    for _ in range(2):
        node: dict[tuple[int, int], pymunk.Body] = {}
        for place in ((i, j) for i in range(5) for j in range(1, 5)):
            body = pymunk.Body()
            body.position = (20.0 * place[0], -20.0 * place[1])
            shape = pymunk.Circle(body, 4.0)
            shape.density, shape.elasticity = 1.0, 0.8
            space.add(body, shape)
            node[place] = body
        pins = []
        for (i, j), body in node.items():
            if j == 1:
                nail = pymunk.Body(body_type=pymunk.Body.STATIC)
                nail.position = (20.0 * i, 0.0)
                pins.append(pymunk.PinJoint(body, nail))
            pins += [pymunk.PinJoint(body, node[n]) for n in ((i, j + 1), (i + 1, j)) if n in node]
        space.add(*pins)
        for body in node.values():
            body.apply_impulse_at_local_point((2000.0, 0.0))
        for _ in range(100):
            stepper.step(1 / 200)
            off = (abs((p.a.position - p.b.position).length - 20.0) for p in pins)
            longest = max(longest, *off)
        ends.append([tuple(b.position) for b in node.values()])
        space.remove(*space.bodies, *space.shapes, *space.constraints)
    assert ends[0] == ends[1]
    assert max(abs(y + 20.0 * j) for (_, y), (_, j) in zip(ends[0], node, strict=True)) > 0.5
    assert longest < (1e-9 if make is OURS else 2.0)


@both
def test_a_ramp_that_is_scrolled_under_a_box(make: Make) -> None:
    """motorcycle_game: a static body is moved by whole pixels before each step and never reindexed. Ours feels it;
    under native the box falls through it."""
    space = pymunk.Space()
    space.gravity = (0.0, 1000.0)
    ramp, box = pymunk.Body(body_type=pymunk.Body.STATIC), pymunk.Body(1.0, pymunk.moment_for_box(1.0, (30.0, 30.0)))
    ramp.position, box.position = (600.0, 300.0), (100.0, 0.0)
    space.add(ramp, pymunk.Poly(ramp, [(-100, 0), (100, 0), (100, 50), (-100, 50)]))
    space.add(box, pymunk.Poly.create_box(box, (30.0, 30.0)))
    space.add(pymunk.Segment(space.static_body, (-1000.0, 600.0), (2000.0, 600.0), 0.0))
    stepper = make(space)
    for _ in range(120):
        if ramp.position.x > 100.0:
            ramp.position = (int(ramp.position.x - 20.0), 300.0)
        stepper.step(1 / 60)
    assert box.position == pytest.approx((100.0, 285.0 if make is OURS else 585.0), abs=0.5)


def test_a_tip_that_pushes_a_tee_does_not_bounce_on_it() -> None:
    """gym-pusht: nothing accelerates the tee, so that no closing acceleration ends bounces; e = 0 leaves none."""
    space, dt, before = push_t()
    stepper, most = ep.EECA(space), 0
    for k in range(300):
        before(k)
        most = max(most, len(stepper.step(dt).contacts))
    assert 0 < most <= 8
