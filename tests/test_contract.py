"""What every stepper promises of `step`."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.space.private import spaces as private
from scenes.scene import add_disk, add_walls

from .steppers import ALL, ARRAYS, Make, one_disk, state

every = pytest.mark.parametrize("make", ALL.values(), ids=ALL.keys())
arrays = pytest.mark.parametrize("make", ARRAYS.values(), ids=ARRAYS.keys())


@every
def test_zero_dt_does_nothing(make: Make) -> None:
    space, body = one_disk()
    body.apply_force_at_world_point((3.0, 1.0), body.position)
    stepper, before = make(space), state(space)
    assert len(stepper.step(0.0).contacts) == 0
    assert state(space) == before
    assert stepper.time == 0.0


@every
@pytest.mark.parametrize("dt", [-1e-3, math.nan, math.inf, -math.inf])
def test_bad_dt_names_value_and_moves_nothing(make: Make, dt: float) -> None:
    space, _ = one_disk()
    stepper, before = make(space), state(space)
    with pytest.raises(ValueError, match=f"dt = {dt}.*finite"):
        stepper.step(dt)
    assert state(space) == before


@every
@pytest.mark.parametrize("field", ["position", "velocity", "force"])
@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_state_that_is_not_finite_is_refused(make: Make, field: str, value: float) -> None:
    space, body = one_disk()
    other = add_disk(space, (3.0, 1.0), 0.1, velocity=(1.0, 0.0))
    stepper = make(space)
    setattr(body, field, (0.0, value))
    with pytest.raises(ValueError, match=rf"{field}\.y of .*{value}"):
        stepper.step(0.01)
    assert other.position == (3.0, 1.0)
    assert other.velocity == (1.0, 0.0)


@every
def test_free_flight_of_body_without_contact(make: Make) -> None:
    space, body = one_disk(velocity=(1.0, 2.0))
    body.angular_velocity = 3.0
    stepper = make(space)
    for _ in range(10):
        stepper.step(0.01)
    np.testing.assert_allclose(body.position, (0.1, 1.2), atol=1e-14)
    assert body.angle == pytest.approx(0.3, abs=1e-14)
    assert stepper.time == pytest.approx(0.1)


@arrays
def test_parabola_with_force_and_torque_is_exact(make: Make) -> None:
    # Constant force: x = x0 + v t + a t² / 2 at any dt, where native's Euler steps err by a t dt / 2.
    space, body = one_disk(velocity=(1.0, 2.0), gravity=9.81)
    stepper = make(space)
    for _ in range(4):
        body.force, body.torque = (5.0, 0.0), 0.02
        stepper.step(0.05)
    t = 0.2
    np.testing.assert_allclose(body.position, (t + 2.5 * t * t, 1 + 2 * t - 4.905 * t * t), atol=1e-14)
    assert body.angle == pytest.approx(0.5 * 0.02 / body.moment * t * t, rel=1e-12)


@every
def test_forces_are_reset_and_settings_kept(make: Make) -> None:
    space, body = one_disk(gravity=9.81)
    space.iterations, space.collision_bias = 17, 0.25
    body.force, body.torque = (1.0, 2.0), 3.0
    stepper = make(space)
    settings = state(space)[0]
    stepper.step(0.02)
    assert state(space)[0] == settings
    assert body.force == (0.0, 0.0)
    assert body.torque == 0.0
    assert space.current_time_step == 0.02


@every
def test_bodies_come_and_go_between_steps(make: Make) -> None:
    space, body = one_disk(velocity=(0.0, -1.0))
    stepper = make(space)
    stepper.step(0.01)
    new = add_disk(space, (2.0, 0.3), 0.1, velocity=(0.0, -1.0))
    for _ in range(40):
        stepper.step(0.01)
    assert new.velocity.y > 0.0  # it met the floor
    space.remove(body, *body.shapes)
    where = body.position
    for _ in range(5):
        stepper.step(0.01)
    assert body.position == where
    for shape in list(space.shapes):
        space.remove(shape)
    for other in list(space.bodies):
        space.remove(other)
    stepper.step(0.01)  # an emptied space


@arrays
def test_refresh_takes_up_shapes_edited_in_place(make: Make) -> None:
    space, body = one_disk(velocity=(0.0, -1.0))
    stepper = make(space)
    stepper.step(0.01)
    next(iter(body.shapes)).unsafe_set_radius(0.5)  # type: ignore[attr-defined]
    stepper.refresh()
    body.position = (0.0, 0.55)
    for _ in range(12):
        stepper.step(0.01)
    assert body.velocity.y > 0


@arrays
def test_walls_moved_between_steps_are_seen(make: Make) -> None:
    space = pymunk.Space()
    disk = add_disk(space, (0.0, 1.0), 0.1, velocity=(0.0, -1.0))
    table = pymunk.Body(body_type=pymunk.Body.STATIC)
    shape = pymunk.Poly.create_box(table, (2.0, 0.2))
    shape.elasticity = 1.0
    space.add(table, shape)
    stepper = make(space)
    stepper.step(0.01)
    table.position = (0.0, 0.7)
    for _ in range(20):
        stepper.step(0.01)
    assert disk.velocity.y > 0


@arrays
def test_queries_see_the_new_positions(make: Make) -> None:
    space, body = one_disk(velocity=(5.0, 0.0))
    stepper = make(space)
    for _ in range(10):
        stepper.step(0.1)
    hit = space.point_query_nearest(body.position, 0.0, pymunk.ShapeFilter())
    assert hit is not None
    assert hit.shape.body is body


def test_native_refuses_what_it_cannot_step_and_is_as_before() -> None:
    space, body = one_disk(velocity=(0.3, -1.0))
    native = ep.Native(space)
    for value, said in ((math.nan, "nan"), (math.inf, "inf")):
        space.gravity = (0.0, value)
        with pytest.raises(ValueError, match=rf"space\.gravity = .*{said}"):
            native.step(0.1)
    space.gravity, body.force = (0.0, 0.0), (1e308, 0.0)
    before = body.position, body.velocity, body.force
    with pytest.raises(ValueError, match=r"(position|velocity)\.x of .* is inf: the step would overflow"):
        native.step(1e3)
    assert (body.position, body.velocity, body.force) == before
    assert native.time == 0.0
    body.force = (0.0, 0.0)
    native.step(0.1)
    assert body.position == pytest.approx(before[0] + 0.1 * before[1])
    hit = space.point_query_nearest(body.position, 0.0, pymunk.ShapeFilter())
    assert hit is not None
    assert hit.shape.body is body


def test_native_may_follow_eeca_and_the_other_way_round() -> None:
    space, body = one_disk(velocity=(0.3, -1.0), gravity=9.81)
    eeca, native = ep.EECA(space), ep.Native(space)
    energy = ep.measure(space).energy
    for k in range(600):
        (eeca if k % 2 else native).step(1e-3)
    assert ep.measure(space).energy == pytest.approx(energy, rel=0.02)  # native's share: first order
    assert 0.0 < body.position.y < 1.2


@arrays
def test_post_step_callback_may_remove_and_add_bodies(make: Make) -> None:
    space, body = one_disk(velocity=(0.3, 1.0))
    others = [add_disk(space, (float(i), 5.0), 0.1, velocity=(0.0, float(i))) for i in range(1, 6)]
    stepper = make(space)
    added: list[pymunk.Body] = []

    def change(space: pymunk.Space) -> None:
        space.remove(others[1], *others[1].shapes)
        added.append(add_disk(space, (9.0, 9.0), 0.1, velocity=(7.0, 0.0)))

    space.add_post_step_callback(lambda space, key: change(space), "change")
    stepper.step(0.01)
    assert others[1] not in space.bodies
    assert body.velocity == (0.3, 1.0)
    assert [b.velocity.y for i, b in enumerate(others) if i != 1] == [1.0, 3.0, 4.0, 5.0]
    stepper.step(0.01)
    assert added[0].position.x > 9.0
    assert others[4].position.y == pytest.approx(5.1)


@arrays
def test_fault_while_writing_leaves_the_space_as_it_was(make: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    space, body = one_disk(velocity=(0.3, -1.0), gravity=9.81)
    body.force = (1.0, 0.0)
    stepper, before = make(space), state(space)

    def fail(space: pymunk.Space, dt: float) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(private, "step_without_end", fail)
        with pytest.raises(KeyboardInterrupt):
            stepper.step(0.01)
    assert state(space) == before
    assert stepper.time == 0.0
    stepper.step(0.01)
    assert body.position.x > 0.0


@arrays
def test_overflow_is_an_error_and_moves_nothing(make: Make) -> None:
    space, _ = one_disk(velocity=(1e308, 0.0))
    stepper, before = make(space), state(space)
    with pytest.raises(ValueError, match="overflow"):
        stepper.step(100.0)
    assert state(space) == before


def friction(space: pymunk.Space, body: pymunk.Body) -> object:
    for shape in space.shapes:
        shape.friction = 0.5
    return next(iter(body.shapes))


def offset(space: pymunk.Space, body: pymunk.Body) -> object:
    shape = pymunk.Circle(body, 0.1, (0.1, 0.0))
    space.add(shape)
    return shape


def box(space: pymunk.Space, body: pymunk.Body) -> object:
    shape = pymunk.Poly.create_box(body)
    space.add(shape)
    return shape


def kinematic(space: pymunk.Space, body: pymunk.Body) -> object:
    mover = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    space.add(mover, pymunk.Circle(mover, 0.1))
    return mover


def joint(space: pymunk.Space, body: pymunk.Body) -> object:
    constraint = pymunk.PinJoint(body, space.static_body)
    space.add(constraint)
    return constraint


TURNING = (offset, box, kinematic)
DISKS_ALONE = [make for name, make in ARRAYS.items() if name not in ("time_of_impact", "midstep")]


def refused(make: Make, spoil, when: str) -> None:
    space, body = one_disk()
    stepper = make(space) if when == "after" else None
    culprit = spoil(space, body)
    before = state(space)
    if stepper is not None:
        stepper.refresh()
    with pytest.raises(ep.UnsupportedFeature) as error:
        (stepper or make(space)).step(0.01)
    assert str(culprit) in str(error.value)
    assert state(space) == before


@pytest.mark.parametrize("make", DISKS_ALONE)
@pytest.mark.parametrize("spoil", [*TURNING, friction, joint])
@pytest.mark.parametrize("when", ["before", "after"])
def test_what_turns_and_friction_are_refused_by_those_who_move_disks(make: Make, spoil, when: str) -> None:
    refused(make, spoil, when)


@every
def test_massless_body_is_refused_with_a_remedy(make: Make) -> None:
    space = pymunk.Space()
    body = pymunk.Body()
    space.add(body, pymunk.Circle(body, 0.1))
    with pytest.raises(ValueError, match=r"mass 0\.0.*set body\.mass"):
        make(space).step(0.01)


@pytest.mark.parametrize("stiffness", [0.0, -1.0, math.nan, math.inf])
def test_bad_stiffness(stiffness: float) -> None:
    space, _ = one_disk()
    for make in (
        lambda: ep.Dashpot(stiffness, 1.0),
        lambda: ep.PenaltyEnergyMomentum(space, stiffness),
        lambda: ep.Newmark.trapezoidal(space, stiffness),
    ):
        with pytest.raises(ValueError, match=f"stiffness = {stiffness}"):
            make()


@pytest.mark.parametrize(("beta", "gamma"), [(0.0, 0.5), (0.6, 0.5), (0.25, -0.1), (0.25, 1.1), (math.nan, 0.5)])
def test_bad_newmark_parameters(beta: float, gamma: float) -> None:
    with pytest.raises(ValueError, match=r"(beta|gamma) = "):
        ep.Newmark(one_disk()[0], 1e6, beta, gamma)


@pytest.mark.parametrize(
    ("name", "value"),
    [("tolerance", math.nan), ("tolerance", -1.0), ("tolerance", 0.0), ("max_iterations", 0), ("max_iterations", 1.5)],
)
def test_bad_arguments_of_the_dashpot(name: str, value: float) -> None:
    with pytest.raises((ValueError, TypeError), match=f"{name} = {value}: give"):
        ep.Dashpot(1e6, 1.0, **{name: value})


@pytest.mark.parametrize("most", [-1, 1.5, math.nan, 10**19])
def test_bad_numbers_of_impacts(most: int) -> None:
    with pytest.raises((ValueError, TypeError), match=r"max_impacts = .*: give a whole number from 0"):
        ep.TimeOfImpact(most)
    ep.EECA(one_disk(velocity=(0.0, -1.0))[0], ep.TimeOfImpact(2**31 - 1)).run(100, 0.01)


@pytest.mark.parametrize("closure", [ep.TimeOfImpact, "midstep", 3])
def test_closures_are_instances(closure: object) -> None:
    with pytest.raises(TypeError, match=r"closure = .*: give an instance"):
        ep.EECA(one_disk()[0], closure)  # type: ignore[arg-type]


@pytest.mark.parametrize("ratio", [-1.0, math.nan, math.inf])
def test_bad_damping_ratio(ratio: float) -> None:
    with pytest.raises(ValueError, match=f"damping_ratio = {ratio}"):
        ep.Dashpot(1e6, ratio)


def test_bodies_without_shapes_and_sensors_take_no_part() -> None:
    space, body = one_disk(velocity=(0.0, -1.0))
    ghost = pymunk.Body(1.0, 1.0)
    ghost.velocity = (1.0, 0.0)
    sensor = pymunk.Segment(space.static_body, (-1.0, 0.5), (1.0, 0.5), 0.0)
    sensor.sensor = True
    space.add(ghost, sensor)
    stepper = ep.EECA(space)
    for _ in range(60):
        stepper.step(0.01)
    assert body.position.y == pytest.approx(0.4)
    assert ghost.position == pytest.approx((0.6, 0.0))


def test_filtered_shapes_pass_through() -> None:
    space = pymunk.Space()
    a = add_disk(space, (0.0, 0.0), 0.1, velocity=(1.0, 0.0))
    b = add_disk(space, (0.5, 0.0), 0.1)
    for body in (a, b):
        for shape in body.shapes:
            shape.filter = pymunk.ShapeFilter(group=1)
    stepper = ep.EECA(space)
    for _ in range(100):
        stepper.step(0.01)
    assert a.position.x == pytest.approx(1.0)
    assert b.velocity == (0.0, 0.0)


def test_two_runs_of_a_scene_are_bitwise_equal() -> None:
    import scenes

    ends = []
    for _ in range(2):
        scene = scenes.build("hopper", columns=8, layers=6)
        stepper = ep.EECA(scene.space)
        clutter = [object() for _ in range(1000)]  # other memory addresses: pymunk orders arbiters by them
        for _ in range(160):
            stepper.step(scene.dt)
        ends.append([(*b.position, *b.velocity) for b in scene.bodies])
        del clutter
    assert ends[0] == ends[1]


def test_walls_of_spaces_far_away_meet_disks() -> None:
    space = pymunk.Space()
    far = 1e6
    body = add_disk(space, (far, far + 1.0), 0.1, velocity=(0.0, -1.0))
    add_walls(space, [((far - 1, far), (far + 1, far))])
    stepper = ep.EECA(space)
    for _ in range(100):
        stepper.step(0.01)
    assert body.velocity == (0.0, 1.0)
