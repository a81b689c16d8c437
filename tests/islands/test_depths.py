"""How long intervals are whose contacts close: bodies on a turning wall, and ways of second order."""

from __future__ import annotations

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.compiled.records import zeros
from eeca_pymunk.geometry.gap import gap_at
from eeca_pymunk.geometry.sides import note_side
from eeca_pymunk.geometry.widths import depth_limit
from eeca_pymunk.islands.depths import closes_too_far, closing_allowed, deep_at_end
from eeca_pymunk.model.contacts import ROW
from eeca_pymunk.model.islands import Island
from eeca_pymunk.model.parameters.intervals import INTERVAL_RETRY

SPIN, G, DT, LIMIT = 1.0, 9.81, 0.1, 1e-4  # rad/s, lengths/s², s, depth in parts of a rod that an interval may reach


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e2])
def test_an_interval_is_as_long_as_the_poses_at_its_end_allow(unit: float) -> None:
    """Rods without width slide on a wall without width. Along the normal of the middle of an interval h one of speed s
    seems to close at s SPIN h / 2 at its start, where its way is along the wall. By the rows alone the second and the
    third step would not be one interval."""
    space = pymunk.Space()
    space.gravity = 0.0, -G * unit
    axis = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    axis.angular_velocity = SPIN
    space.add(axis, pymunk.Segment(axis, (-5.0 * unit, 0.0), (5.0 * unit, 0.0), 0.0))
    rods = []
    for x in (-2.0, 0.5, 2.0):
        rod = pymunk.Body(1.0, unit * unit / 3.0)
        rod.position = x * unit, 0.0
        rod.velocity, rod.angular_velocity = axis.velocity_at_world_point(rod.position), SPIN
        space.add(rod, pymunk.Segment(rod, (-0.5 * unit, 0.0), (0.5 * unit, 0.0), 0.0))
        rods.append(rod)
    stepper = ep.EECA(space)
    for _ in range(3):
        report = stepper.step(DT)
        assert report.converged
        assert min(axis.world_to_local(rod.position).y for rod in rods) >= -1.5 * LIMIT * unit
        assert len(report.contacts) <= 6  # two points of each rod, in one interval


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("approach", [0.0, 0.5, 1.0])
def test_the_next_interval_is_as_long_as_a_way_of_second_order_takes(approach: float, unit: float) -> None:
    """A disk closes by u h + c h^2 = 10 d in an interval h, with a part `approach` of that by its velocity u at the
    start, and a room of d: after s, u s + c s^2 = d."""
    space, h, radius = pymunk.Space(), 0.5, 2.0 * unit
    disk = pymunk.Body(1.0, 1.0)
    disk.position = 0.0, radius
    wall = pymunk.Segment(space.static_body, (-9.0 * unit, 0.0), (9.0 * unit, 0.0), 0.0)
    space.add(disk, pymunk.Circle(disk, radius), wall)
    stepper = ep.EECA(space)
    stepper.step(1e-6)
    loop = stepper.event_loop
    assert loop is not None
    room = depth_limit(loop.scene, 0, 1)
    isle = Island(
        WHO=np.array([0, 1]), IM=np.zeros(2), II=np.zeros(2), POSE=np.array([[0.0, radius, 0.0], [0.0, 0.0, 0.0]]),
        V=np.array([[0.0, -approach * 10.0 * room / h, 0.0], [0.0, 0.0, 0.0]]), ACC=np.zeros((2, 3)),
        EXTENT=np.zeros(2), LEVER=np.zeros(2), PAIRS=np.zeros((1, 4), np.int64),
    )  # fmt: skip
    end = isle.POSE - [[0.0, 10.0 * room, 0.0], [0.0, 0.0, 0.0]]
    rows = zeros(1, ROW)
    rows[0].b, rows[0].key = 1, 2
    far = deep_at_end(loop.scene, isle, end, rows, 1, h, 0)
    s, u = h / far, approach * 10.0 * room / h
    assert u * s + (10.0 * room - u * h) * (s / h) ** 2 == pytest.approx(room, rel=1e-9)


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize(("depth", "part"), [(-0.1, 1.0), (0.0, 1.0), (0.4, 1.0), (0.75, 0.5), (0.9, 0.2)])
def test_contacts_near_the_middle_of_their_shapes_may_close_less(depth: float, part: float, held: bool) -> None:
    """In overlap by a part `depth` of the way to the middle; what a joint holds may close as far as before."""
    space, radius = pymunk.Space(), 2.0
    disk = pymunk.Body(1.0, 1.0)
    disk.position = 0.0, 3.0 * radius
    space.add(disk, pymunk.Circle(disk, radius), pymunk.Segment(space.static_body, (-9.0, 0.0), (9.0, 0.0), 0.0))
    if held:
        space.add(pymunk.PinJoint(space.static_body, disk))
    stepper = ep.EECA(space)
    stepper.step(1e-6)
    loop = stepper.event_loop
    assert loop is not None
    gap = -depth * radius
    expected = max(gap, 0.0) + (1.0 if held else part) * depth_limit(loop.scene, 0, 1)
    assert closing_allowed(loop.scene, 0, 1, gap) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("way", [0.01, 0.3, 1.0, 100.0])
def test_an_interval_in_which_a_rod_goes_through_a_wall_is_too_long(way: float, unit: float) -> None:
    """However far: beyond the wall the gap at the end is that of its other side."""
    space, h = pymunk.Space(), 0.5
    rod = pymunk.Body(1.0, 1.0)
    rod.position = 0.0, 0.0
    wall = pymunk.Segment(space.static_body, (-9.0 * unit, 0.0), (9.0 * unit, 0.0), 0.0)
    space.add(rod, pymunk.Segment(rod, (-unit, 0.0), (unit, 0.0), 0.0), wall)
    stepper = ep.EECA(space)
    stepper.step(1e-6)
    loop = stepper.event_loop
    assert loop is not None
    note_side(loop.scene, 0, 1, 0.0, -1.0, True)
    isle = Island(
        WHO=np.array([0, 1]), IM=np.zeros(2), II=np.zeros(2), POSE=np.zeros((2, 3)), V=np.zeros((2, 3)),
        ACC=np.zeros((2, 3)), EXTENT=np.zeros(2), LEVER=np.zeros(2), PAIRS=np.zeros((1, 4), np.int64),
    )  # fmt: skip
    rows, after = zeros(1, ROW), np.array([[0.0, -2.0 * way * unit / h, 0.0], [0.0, 0.0, 0.0]])
    rows[0].b, rows[0].key, rows[0].ny = 1, 2, -1.0
    far = closes_too_far(loop.scene, isle, rows, after, 1, h)
    assert far > INTERVAL_RETRY


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize(("deep", "is_through"), [(0.0, False), (0.01, False), (0.5, True)])
def test_a_rod_in_the_corner_of_a_triangle_is_as_deep_as_the_normal_tells(
    deep: float, is_through: bool, unit: float
) -> None:
    """Its end is .02 below the upper corner, at the start 1e-4 left of it, so that the way out is to the left. At the
    end it is right of it, and lower by `deep`: the way out is to the right, by a normal 120 degrees from the other."""
    space = pymunk.Space()
    rod = pymunk.Body(1.0, 1.0)
    space.add(rod, pymunk.Segment(rod, (0.0, 0.0), (0.0, unit), 0.0))
    corners = [(unit * np.sin(k * np.pi / 1.5), unit * np.cos(k * np.pi / 1.5)) for k in range(3)]
    space.add(pymunk.Poly(space.static_body, corners))
    rod.position = -1e-4 * unit, 0.98 * unit
    stepper = ep.EECA(space)
    stepper.step(1e-9)
    loop = stepper.event_loop
    assert loop is not None
    start = np.array([[-1e-4 * unit, 0.98 * unit, 0.0], [0.0, 0.0, 0.0]])
    isle = Island(
        WHO=np.array([0, 1]), IM=np.zeros(2), II=np.zeros(2), POSE=start, V=np.zeros((2, 3)),
        ACC=np.zeros((2, 3)), EXTENT=np.zeros(2), LEVER=np.zeros(2), PAIRS=np.zeros((1, 4), np.int64),
    )  # fmt: skip
    gap, nx, ny, _, _ = gap_at(loop.scene, 0, *start[0], 1, *start[1])
    assert gap < 0.0
    assert nx > 0.5
    end = start + np.array([[2e-4 * unit, -deep * unit, 0.0], [0.0, 0.0, 0.0]])
    _, mx, my, _, _ = gap_at(loop.scene, 0, *end[0], 1, *end[1])
    assert nx * mx + ny * my == pytest.approx(-0.5)
    rows = zeros(1, ROW)
    rows[0].b, rows[0].key, rows[0].nx, rows[0].ny, rows[0].gap = 1, 2, nx, ny, gap
    assert (deep_at_end(loop.scene, isle, end, rows, 1, 0.5, 0) > INTERVAL_RETRY) == is_through
