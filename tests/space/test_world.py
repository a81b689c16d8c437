"""A pymunk space as packed arrays: which row stands for what, and when the arrays are no longer the space."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk import layout as at
from eeca_pymunk.compiled.records import columns
from eeca_pymunk.model.bodies import POSE, VELOCITY
from eeca_pymunk.space.bodies import Bodies
from eeca_pymunk.space.world import World
from scenes.scene import add_disk


def body(space: pymunk.Space, kind: int = pymunk.Body.DYNAMIC, x: float = 0.0) -> pymunk.Body:
    made = pymunk.Body(2.0, 3.0) if kind == pymunk.Body.DYNAMIC else pymunk.Body(body_type=kind)
    made.position = x, 0.0
    space.add(made)
    return made


def zoo() -> tuple[pymunk.Space, dict[str, pymunk.Body]]:
    """Bodies of every kind, added in another order than their rows have."""
    space = pymunk.Space()
    space.add(pymunk.Segment(space.static_body, (-9.0, -1.0), (9.0, -1.0), 0.1))
    names = {
        "lift": body(space, pymunk.Body.KINEMATIC, 1.0),
        "box": body(space, x=2.0),
        "ball": body(space, x=3.0),
        "pair": body(space, x=4.0),
        "pillar": body(space, pymunk.Body.STATIC, 5.0),
        "stone": body(space, x=6.0),
        "ghost": body(space, x=7.0),
        "eccentric": body(space, x=8.0),
    }
    space.add(
        pymunk.Circle(names["lift"], 0.5),
        pymunk.Poly.create_box(names["box"], (2.0, 4.0), radius=0.25),
        pymunk.Circle(names["ball"], 0.5),
        pymunk.Circle(names["pair"], 0.1),
        pymunk.Circle(names["pair"], 0.2, (0.3, 0.4)),
        pymunk.Circle(names["pillar"], 0.75, (1.0, 0.0)),
        pymunk.Circle(names["stone"], 0.25),
        pymunk.Circle(names["eccentric"], 0.25, (0.0, 1.0)),
    )
    sensor = pymunk.Circle(names["stone"], 5.0)
    sensor.sensor = True
    space.add(sensor)
    names["pillar"].angle = 0.5 * math.pi
    return space, names


def rows(world: World) -> dict[pymunk.Body, int]:
    return {b: int(world.IDS[at.BODY_ROW, i]) for i, b in enumerate(world.bodies.items)}


def test_lone_disks_come_first_then_other_dynamic_bodies_then_kinematic_ones_and_the_ground_last() -> None:
    space, names = zoo()
    world = World(space)
    row = rows(world)
    assert (world.disks, world.dynamic, len(world.BODY)) == (2, 6, 8)
    assert {row[names[n]] for n in ("ball", "stone")} == {0, 1}
    assert {row[names[n]] for n in ("box", "pair", "ghost", "eccentric")} == {2, 3, 4, 5}
    assert row[names["lift"]] == 6
    assert row[names["pillar"]] == row[space.static_body] == -1
    for name, one in names.items():
        if row[one] >= 0:
            mobile = one.body_type == pymunk.Body.DYNAMIC
            assert world.BODY["inv_mass"][row[one]] == (0.5 if mobile else 0.0), name
            assert world.BODY["inv_inertia"][row[one]] == (1.0 / 3.0 if mobile else 0.0), name
    assert not any(world.BODY[-1][name] for name in (*POSE, *VELOCITY))


def test_shapes_are_ordered_by_body_and_static_ones_stand_on_the_ground_in_world_coordinates() -> None:
    space, names = zoo()
    world = World(space)
    row, owner = rows(world), world.LINK["owner"]
    assert (np.diff(owner) >= 0).all()
    assert owner[: world.disks].tolist() == [0, 1]
    assert len(world.shapes) == 9  # without the sensor
    assert [world.bodies.items[i] for i in world.owner] == [s.body for s in world.shapes]
    for k, shape in enumerate(world.shapes):
        assert shape.body is not None
        assert owner[k] == (row[shape.body] if row[shape.body] >= 0 else len(world.BODY) - 1)
        assert world.SHAPE["rounding"][k] == shape.radius  # type: ignore[attr-defined]
        if shape.body is names["pillar"]:
            first = world.LINK["first"][k]
            assert world.VERTEX[first, :2] == pytest.approx((5.0, 1.0))
            assert world.LINK["vertices"][k] == 1
    assert world.LINK["first"][0] == 0
    assert (np.diff(world.LINK["first"]) == world.LINK["vertices"][:-1]).all()


def test_outlines_turn_counter_clockwise_with_normals_outward() -> None:
    space, names = zoo()
    names["pillar"].angle = 2.0
    space.add(pymunk.Poly(names["pillar"], [(0.0, 0.0), (0.0, 1.0), (2.0, 0.0)]))
    world = World(space)
    polygons = 0
    for k in range(len(world.shapes)):
        first, count = world.LINK[k].first, world.LINK[k].vertices
        vertex, normal = np.split(world.VERTEX[first : first + count], 2, axis=1)
        if count == 1:
            assert not normal.any()
            continue
        edge = np.roll(vertex, -1, axis=0) - vertex
        assert np.hypot(*normal.T) == pytest.approx(1.0)
        assert (edge * normal).sum(axis=1) == pytest.approx(0.0, abs=1e-12)
        # All vertices lie behind every edge, those of a segment on both.
        depth = (vertex[None] - vertex[:, None]) @ normal[..., None]
        assert depth.max() <= 1e-12
        if count > 2:
            polygons += 1
            assert (edge[:, 0] * np.roll(edge, -1, axis=0)[:, 1] > edge[:, 1] * np.roll(edge, -1, axis=0)[:, 0]).all()
        else:
            assert normal[0] == pytest.approx(-normal[1])
    assert polygons == 2


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_bounds_hold_the_whole_shape(scale: float) -> None:
    space = pymunk.Space()
    one = body(space)
    space.add(
        pymunk.Poly(one, [(0.0, 0.0), (3.0 * scale, 0.0), (0.0, scale)], radius=0.1 * scale),
        pymunk.Segment(one, (-scale, 0.0), (scale, 2.0 * scale), 0.2 * scale),
        pymunk.Circle(one, 0.5 * scale, (scale, scale)),
    )
    one.center_of_gravity = (0.2 * scale, 0.1 * scale)
    world = World(space)
    turn = np.linspace(0.0, 2.0 * np.pi, 100)
    for k in range(3):
        first, count = world.LINK[k].first, world.LINK[k].vertices
        S = world.SHAPE[k]
        rim = np.stack((np.cos(turn), np.sin(turn)), axis=1) * S["rounding"]
        points = (world.VERTEX[first : first + count, None, :2] + rim).reshape(-1, 2)
        assert np.hypot(*points.T).max() == pytest.approx(S["extent"], rel=1e-2)
        assert np.hypot(*points.T).max() <= S["extent"] * (1 + 1e-12)
        away = np.hypot(*(points - (S.centre_x, S.centre_y)).T).max()
        assert 0.99 * S["bound"] <= away <= S["bound"] * (1 + 1e-12)
    assert world.BODY["extent"][0] == world.SHAPE["extent"].max()


def test_a_disk_whose_offset_is_its_centre_of_mass_is_a_lone_disk() -> None:
    space = pymunk.Space()
    one = body(space)
    one.center_of_gravity = (0.5, 0.25)
    space.add(pymunk.Circle(one, 0.1, (0.5, 0.25)))
    assert World(space).disks == 1


def test_a_segment_of_no_length_is_a_disk() -> None:
    space = pymunk.Space()
    space.add(pymunk.Segment(space.static_body, (1.0, 2.0), (1.0, 2.0), 0.1))
    world = World(space)
    assert world.LINK["vertices"][0] == 1
    assert world.VERTEX.tolist() == [[1.0, 2.0, 0.0, 0.0]]


def test_materials_and_filters() -> None:
    space = pymunk.Space()
    shape = next(iter(add_disk(space, (0.0, 0.0), 0.1).shapes))
    shape.elasticity, shape.friction = 0.75, 0.5
    shape.filter = pymunk.ShapeFilter(7, 0b101, 0xFFFFFFFE)
    world = World(space)
    assert columns(world.LINK[0], "group", "categories", "mask").tolist() == [7, 5, 0xFFFFFFFE]
    assert columns(world.SHAPE[0], "elasticity", "friction").tolist() == [0.75, 0.5]
    assert columns(world.BODY[0], "elasticity", "friction", "extent").tolist() == [0.75, 0.5, 0.1]


def test_a_space_without_anything() -> None:
    world = World(pymunk.Space())
    assert (len(world.BODY), len(world.SHAPE), len(world.VERTEX), world.disks) == (1, 0, 0, 0)
    world.gather()
    assert world.is_current()


def set_gravity(space: pymunk.Space) -> None:
    space.gravity = (math.nan, 0.0)


def set_damping(space: pymunk.Space) -> None:
    space.damping = math.inf


def add_joint(space: pymunk.Space) -> None:
    space.add(pymunk.PivotJoint(next(iter(space.bodies)), space.static_body, (math.nan, 0.0), (0.0, 0.0)))


def edit(name: str, value: object) -> Callable[[pymunk.Space], None]:
    return lambda space: setattr(next(iter(space.shapes)), name, value)


@pytest.mark.parametrize(
    ("spoil", "kind", "message"),
    [
        (set_gravity, ValueError, "space.gravity"),
        (set_damping, ValueError, "space.damping = inf"),
        (add_joint, ValueError, "PivotJoint.* has anchor_a"),
        (edit("surface_velocity", (math.nan, 0.0)), ValueError, "surface velocity"),
        (edit("elasticity", math.inf), ValueError, "elasticity inf"),
    ],
)
def test_what_cannot_be_stepped_is_refused(
    spoil: Callable[[pymunk.Space], None], kind: type[Exception], message: str
) -> None:
    space = pymunk.Space()
    add_disk(space, (0.0, 0.0), 0.1)
    world = World(space)
    spoil(space)
    with pytest.raises(kind, match=message):
        World(space)
    if spoil in (set_gravity, set_damping, add_joint):
        assert not world.current()
        with pytest.raises(kind, match=message):
            world.read_settings()


def test_friction_is_read_or_ignored() -> None:
    space = pymunk.Space()
    for x in (0.0, 1.0):
        for shape in add_disk(space, (x, 0.0), 0.1).shapes:
            shape.friction = 0.5
    assert World(space).SHAPE["friction"].tolist() == [0.5, 0.5]
    ignoring = World(space, ("friction",))
    assert ignoring.lacks_friction
    assert not ignoring.SHAPE["friction"].any()


@pytest.mark.parametrize("radius", [-0.1, math.nan, math.inf])
def test_a_radius_that_is_none_is_refused_by_name(radius: float) -> None:
    space = pymunk.Space()
    body = pymunk.Body(1.0, 1.0)
    disk = pymunk.Circle(body, 0.5)
    space.add(body, disk)
    disk.unsafe_set_radius(radius)
    with pytest.raises(ValueError, match=rf"Circle.*radius {radius}: set"):
        ep.EECA(space)


def test_masses_that_no_body_can_have_are_refused() -> None:
    space = pymunk.Space()
    one = pymunk.Body()
    space.add(one)
    with pytest.raises(ValueError, match=r"mass 0\.0 and moment 0\.0"):
        World(space)


CHANGES: dict[str, Callable[[pymunk.Space], object]] = {
    "gravity": lambda space: setattr(space, "gravity", (0.0, 1.0)),
    "damping": lambda space: setattr(space, "damping", 0.5),
    "handler": lambda space: space.on_collision(begin=lambda *_: None),
    "body added": lambda space: space.add(pymunk.Body(1.0, 1.0)),
    "body removed": lambda space: space.remove(list(space.bodies)[1]),
    "shape added": lambda space: space.add(pymunk.Circle(space.static_body, 1.0)),
    "shape removed": lambda space: space.remove(next(iter(space.shapes))),
    "shape exchanged": lambda space: (
        space.add(pymunk.Circle(space.static_body, 1.0)),
        space.remove(next(iter(space.shapes))),
    ),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES.keys())
def test_changes_are_seen(change: Callable[[pymunk.Space], object]) -> None:
    space = pymunk.Space()
    add_disk(space, (0.0, 0.0), 0.1)
    space.add(pymunk.Body(1.0, 1.0))
    world = World(space)
    assert world.current()
    change(space)
    assert not world.current()


@pytest.mark.parametrize("change", ["none", "gravity", "damping", "handler"])
def test_settings_are_read_anew_without_the_shapes(change: str) -> None:
    space = pymunk.Space()
    add_disk(space, (0.0, 0.0), 0.1)
    world = World(space)
    if change != "none":
        CHANGES[change](space)
    assert world.same_things()
    assert not world.edited()
    world.read_settings()
    assert world.current()
    assert (world.gravity, world.damping) == (tuple(space.gravity), space.damping)
    assert world.collisions == world.hooked_steps == (change == "handler")


def test_an_exchanged_body_and_a_moved_static_one_show_in_what_is_read() -> None:
    space = pymunk.Space()
    disk, pillar = add_disk(space, (0.0, 0.0), 0.1), body(space, pymunk.Body.STATIC)
    world = World(space)
    world.gather()
    assert world.is_current()
    disk.position = (1.0, 0.0)
    world.gather()
    assert world.is_current()
    pillar.position = (1.0, 0.0)
    world.gather()
    assert not world.is_current()
    pillar.position = (0.0, 0.0)
    spare, other = body(space), pymunk.Body(1.0, 1.0)
    world = World(space)
    space.remove(spare)
    space.add(other)
    assert not world.current()
    assert not world.same_things()
    world.gather()
    assert not world.is_current()


@pytest.mark.parametrize("count", [0, 1, 3, 200])
def test_the_state_is_that_of_the_bodies(count: int) -> None:
    space = pymunk.Space()
    random = np.random.default_rng(count)
    for _ in range(count):
        one = body(space, x=random.normal())
        one.angle, one.angular_velocity, one.torque = random.normal(size=3)
        one.velocity, one.force = random.normal(size=2).tolist(), random.normal(size=2).tolist()
    world = World(space)
    for _ in range(3):
        world.gather()
    for one, row in zip(world.bodies.items, world.state.tolist(), strict=True):
        assert row == [*one.position, one.angle, *one.velocity, one.angular_velocity, *one.force, one.torque]
    before = world.state.copy()
    for one in space.bodies:
        one.position, one.velocity, one.angle, one.force, one.torque = (9.0, 9.0), (9.0, 9.0), 9.0, (9.0, 9.0), 9.0
    world.bodies.scatter(world.state, unchanged=True)
    world.gather()
    assert np.array_equal(world.state, before)


def test_reading_warns_of_nothing() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        World(zoo()[0])


def test_measuring_keeps_no_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    """`pymunk.batch.Buffer` never frees its memory, some 20 kB a time for 100 bodies."""

    def refuse() -> None:
        raise AssertionError("a buffer is made")

    space = zoo()[0]
    energy = ep.measure(space).energy
    monkeypatch.setattr(pymunk.batch, "Buffer", refuse)
    assert ep.measure(space).energy == energy
    bodies = Bodies(space)
    bodies.scatter(bodies.start)
    ep.Native(space).step(0.1)
