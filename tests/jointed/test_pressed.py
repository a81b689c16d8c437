"""Light bodies that joints of bounded force press into corners: without losses no depth is corrected, none adds up."""

from __future__ import annotations

import math

import pymunk
import pytest

import eeca_pymunk as ep

DT = 1 / 60


def wall(body: pymunk.Body, p: tuple[float, float], q: tuple[float, float]) -> None:
    """A segment without width and losses."""
    segment = pymunk.Segment(body, p, q, 0.0)
    segment.elasticity = 1.0
    assert body.space is not None
    body.space.add(segment)


def elastic(space: pymunk.Space, body: pymunk.Body, size: float, corners: int = 5) -> pymunk.Poly:
    """A regular polygon without losses."""
    angles = [2.0 * math.pi * k / corners for k in range(corners)]
    shape = pymunk.Poly(body, [(size * math.cos(angle), size * math.sin(angle)) for angle in angles])
    shape.elasticity = 1.0
    space.add(body, shape)
    return shape


@pytest.mark.parametrize("unit", [1e-3, 1.0, 50.0])
@pytest.mark.parametrize("force", [1e4, 1e5])
def test_impacts_that_are_passed_over_add_no_depth(force: float, unit: float) -> None:
    """A heavy body drives a light one, which it holds by a force that gives it 1e4 lengths/s² and more, into a corner:
    it bounces more often in a step than its island may be hit. It had sunk by .015 lengths in each step."""
    space = pymunk.Space()
    for p, q in (((-9.0, 0.0), (9.0, 0.0)), ((0.0, -9.0), (0.0, 9.0))):
        wall(space.static_body, (p[0] * unit, p[1] * unit), (q[0] * unit, q[1] * unit))
    light, heavy = pymunk.Body(1.0, 0.1 * unit**2), pymunk.Body(1000.0, 1000.0 * unit**2)
    light.position, light.angle = (0.6 * unit, 0.7 * unit), 0.7
    heavy.position, heavy.velocity = (5.0 * unit, 5.0 * unit), (-3.0 * unit, -3.0 * unit)
    shape = elastic(space, light, 0.5 * unit)
    holds = pymunk.PivotJoint(heavy, light, light.position)
    holds.max_force = force * unit
    space.add(heavy, holds)
    stepper, deep = ep.EECA(space), 0.0
    half_width = 0.25 * unit * (1.0 + math.cos(math.pi / 5.0))
    for _ in range(20):
        stepper.step(DT)
        corners = [light.local_to_world(corner) for corner in shape.get_vertices()]
        deep = max(deep, *(-min(corner.x, corner.y) for corner in corners))
    assert 0.0 < deep <= 0.1 * half_width


def test_an_interval_that_ends_at_an_impact_leads_no_deeper_elsewhere() -> None:
    """A body of 30 kg in a groove of one of 7000 kg, .14 deep in one wall of a box that turns, bounces between this and
    another one. On the path of a long interval it would leave the first wall, on that up to the next impact it sinks.
    It had come .27 deeper within 12 steps."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    box, heavy, light = (
        pymunk.Body(body_type=pymunk.Body.KINEMATIC),
        pymunk.Body(7292.0, 157.6),
        pymunk.Body(30.1, 3.158),
    )
    box.position, box.angle = (-0.7737100342678153, 0.0642037557237049), 2.1408951027710192
    box.velocity, box.angular_velocity = (0.37797774271298024, 0.7984871126234903), 0.9916648104524686
    heavy.position, heavy.angle = (2.0792210124037713, -1.5011630206192486), 2.8660509489759747
    heavy.velocity, heavy.angular_velocity = (-4.02898899220282, 0.8981550357002468), 1.4430905690210893
    light.position, light.angle = (-2.3045759590737975, -6.268279087310642), -1.8836673981727503
    light.velocity, light.angular_velocity = (5.903844652240208, 1.0585633447905656), 1.053180822612431
    space.add(box)
    places = [(-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0)]
    for k in range(4):
        wall(box, places[k - 1], places[k])
    elastic(space, heavy, 0.232471, 3)
    shape = elastic(space, light, 0.512194)
    groove = pymunk.GrooveJoint(
        heavy, light, (4.013194972376591, 7.014869578286679), (5.007525336863422, 7.121204550236119),
        (0.10248411315623507, -0.016252810237282755),
    )  # fmt: skip
    groove.max_force, groove.collide_bodies = 729179.6764480916, False
    space.add(groove)
    stepper, deep = ep.EECA(space), 0.0
    for _ in range(12):
        stepper.step(DT)
        corners = [box.world_to_local(light.local_to_world(corner)) for corner in shape.get_vertices()]
        deep = max(deep, *(max(abs(corner.x), abs(corner.y)) - 5.0 for corner in corners))
    assert 0.13 < deep < 0.2
