"""The equations of joints against numpy: rows and their derivatives, and the three linear systems."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from comparisons import program_joints
from eeca_pymunk.arrays import FloatArray
from eeca_pymunk.compiled.records import kind_of, zeros
from eeca_pymunk.joints.ordering import order_unknowns
from eeca_pymunk.joints.workspace import workspace
from eeca_pymunk.model.joint_steps import STEP, STIFF_NONE, STIFF_TURNS, BodyStep, JointStep
from eeca_pymunk.model.joints import STEPS, UNUSED
from eeca_pymunk.newton.angles import shared_turn
from eeca_pymunk.newton.banded import back_banded, factor_banded
from eeca_pymunk.newton.condensed import factor, substitute
from eeca_pymunk.newton.motion import move, seat, size_up
from eeca_pymunk.newton.rows import joint_rows, start_joint
from scenes import linkages
from scenes.linkages import body, empty

from ..joints.driving import Driven


def band_of(matrix: FloatArray, band: int, width: int) -> FloatArray:
    n = len(matrix)
    packed = np.zeros((n, width))
    for i in range(n):
        for j in range(max(0, i - band), min(n, i + band + 1)):
            packed[i, j - i + band] = matrix[i, j]
    return packed.ravel()


@pytest.mark.parametrize(("n", "band"), [(1, 2), (5, 2), (17, 4), (40, 11)])
def test_banded_systems_with_zeros_on_the_diagonal(n: int, band: int) -> None:
    rng = np.random.default_rng(n)
    full = rng.normal(size=(n, n))
    full[np.abs(np.subtract.outer(np.arange(n), np.arange(n))) > band] = 0.0
    if n > 2:
        full[::3, ::3] = 0.0
    right = rng.normal(size=n)
    expected = np.linalg.solve(full, right)
    packed, pivots = band_of(full, band, 3 * band + 1), np.zeros(2 * n, np.int64)
    assert factor_banded(packed, n, band, pivots)
    back_banded(packed, n, band, pivots, right)
    np.testing.assert_allclose(right, expected, rtol=1e-9, atol=1e-11 * np.abs(expected).max())


def test_banded_tells_of_singular_systems() -> None:
    assert not factor_banded(np.zeros(21), 3, 2, np.zeros(6, np.int64))


@pytest.mark.parametrize("band", [6, 11, 20])
def test_factors_without_pivots(band: int) -> None:
    """Some of whose rows begin later than the band does."""
    rng = np.random.default_rng(2)
    full = rng.normal(size=(30, 30)) + 30.0 * np.eye(30)
    full[np.abs(np.subtract.outer(np.arange(30), np.arange(30))) > band] = 0.0
    for i in range(0, 30, 4):
        full[i, : max(i - 3, 0)] = 0.0
    right = np.concatenate((np.zeros(4), rng.normal(size=30)))
    expected = np.linalg.solve(full, right[4:])
    packed, first = band_of(full, band, 2 * band + 1), np.zeros(30, np.int64)
    assert factor(packed, 30, band, first)
    substitute(packed, 30, band, first, right, 4)
    assert list(first[[3, 28, 29]]) == [0, 25, 29 - band]
    np.testing.assert_allclose(right[4:], expected, rtol=1e-12)
    assert (right[:4] == 0.0).all()


def every_joint() -> pymunk.Space:
    """Two bodies with all joints between them, off their centres."""
    space = empty()
    a, b = body(space, 1.3, 0.7, (0.2, 0.1), 0.3), body(space, 0.8, 0.4, (1.1, -0.6), -0.5)
    a.velocity, a.angular_velocity, b.velocity, b.angular_velocity = (0.3, 1.0), 2.0, (-0.5, 0.4), -3.0
    p, q = (0.3, 0.2), (-0.1, 0.25)
    space.add(
        pymunk.PinJoint(a, b, p, q), pymunk.SlideJoint(a, b, p, q, 0.5, 0.9), pymunk.PivotJoint(a, b, p, q),
        pymunk.GrooveJoint(a, b, (-0.3, 0.1), (1.0, 0.4), q), pymunk.DampedSpring(a, b, p, q, 0.7, 20.0, 3.0),
        pymunk.DampedRotarySpring(a, b, 0.2, 7.0, 2.0), pymunk.RotaryLimitJoint(a, b, -1.0, 0.4),
        pymunk.RatchetJoint(a, b, 0.1, 0.4), pymunk.GearJoint(a, b, 0.3, 2.5), pymunk.SimpleMotor(a, b, 1.5),
    )  # fmt: skip
    return space


class Iterate:
    """The component of `every_joint`, at an iterate of its step."""

    def __init__(self, h: float, bounded: bool = False, static: bool = False) -> None:
        space = every_joint()
        if static:
            next(iter(space.bodies)).body_type = pymunk.Body.KINEMATIC
        self.h, J = h, Driven(space).joints
        for local, joined in zip(J.LOCAL, J.JOINED[:2], strict=True):
            one = list(space.bodies)[joined.body]
            seat(local, joined)
            local.pose[:], local.v0[:] = (*one.position, one.angle), (*one.velocity, one.angular_velocity)
            if joined.freedoms > 0:
                local.mobility[:] = 1.0 / one.mass, 1.0 / one.mass, 1.0 / one.moment
        size_up(J, 0, h)
        self.work = workspace(J, 0)
        self.joint, self.hinge, self.local, self.stiff = J.JOINT, J.HINGE, J.LOCAL, J.STIFF
        rng = np.random.default_rng(5)
        self.hinge["lam"] = rng.normal(size=(10, 2))
        self.joint["push"][[4, 5]] = 0.5
        for k in range(10):
            J.COUPLING[k].side = -1 if k in (1, 7) else 1 if k in (3, 6) else 0
            J.COUPLING[k].bounded = int(bounded or k == 9)
        change = rng.normal(size=(2, 3))
        self.local["v1"] = self.local["v0"] + change
        if static:
            self.local["v1"][0] = self.local["v0"][0]

    def at(self, k: int, shift: FloatArray | None = None) -> tuple[JointStep, int]:
        """Joint k with its bodies' ways shifted, and what of `stiff` is there."""
        keep = self.local.copy()
        if shift is not None:
            self.local["v1"] += shift.reshape(2, 3) * 2.0 / self.h
        move(self.local, 2, self.h)
        start_joint(self.work, k, STEP, self.h)
        lam = self.hinge[k].lam.copy()
        bend = joint_rows(self.work, k, self.h, True)
        found = self.hinge[k : k + 1].copy()[0]
        self.way = self.local["way"].copy()
        self.local[:] = keep
        self.hinge[k].lam[:] = lam
        return found, bend


NAMES = ["pin", "slide", "pivot", "groove", "spring", "rotary spring", "limit", "ratchet", "gear", "motor"]
COUNTS = [1, 1, 2, 2, 0, 0, 1, 1, 1, 1]


@pytest.mark.parametrize("static", [False, True], ids=["free", "kinematic"])
@pytest.mark.parametrize("k", range(9), ids=NAMES[:9])
def test_rows_are_discrete_gradients(k: int, static: bool) -> None:
    # g1 - g0 = J x for any x, large ones too; and F = J^T lam.
    one = Iterate(0.4, static=static)
    found, _ = one.at(k)
    force, way = found.force, one.way.ravel()
    if COUNTS[k] == 0:
        held, ended, damping = found.began, found.ended, found.drag
        stiffness, rest = one.joint[k].stiffness, one.joint[k].rest
        sign = 1.0 if k == 4 else -1.0
        stretch = sign * (ended - held)
        pull = 0.5 - sign * stiffness * (0.5 * (held + ended) - rest) - damping * stretch / one.h
        assert force @ way == pytest.approx(one.h * pull * stretch, rel=1e-12)
        return
    still = Iterate(0.4, static=static)
    still.local["v1"] = -still.local["v0"]
    before = still.at(k)[0]
    for r in range(COUNTS[k]):
        assert found.value[r] - before.value[r] == pytest.approx(found.rows[r] @ way, abs=1e-14)
    lam = one.hinge[k].lam[: COUNTS[k]]
    np.testing.assert_allclose(force, found.rows[: COUNTS[k]].T @ lam, atol=1e-14)


@pytest.mark.parametrize("k", range(10), ids=NAMES)
def test_slopes_and_stiffness_are_derivatives(k: int) -> None:
    # The derivative of torques' common factor is good to the square of the difference of both turns.
    one = Iterate(0.05)
    found, bend = one.at(k)
    stiff = one.stiff.copy() if bend != STIFF_NONE else np.zeros((6, 6))
    if bend == STIFF_TURNS:
        keep = np.zeros((6, 6))
        keep[2, 2], keep[5, 5] = stiff[2, 2], stiff[5, 5]
        stiff = keep
    e = 1e-6
    for c in range(6):
        shift = np.zeros(6)
        shift[c] = e
        up, down = one.at(k, shift)[0], one.at(k, -shift)[0]
        for r in range(COUNTS[k]):
            assert found.slopes[r, c] == pytest.approx((up.value[r] - down.value[r]) / (2.0 * e), abs=1e-8)
        np.testing.assert_allclose(
            stiff[:, c], (up.force - down.force) / (2.0 * e), atol=1e-4 if k in (5, 6, 7) else 1e-7
        )


def test_torques_of_angles_are_opposite() -> None:
    one = Iterate(0.4)
    for k in (5, 6, 7, 9):
        force = one.at(k)[0].force
        assert force[2] == -force[5]
        assert (force[[0, 1, 3, 4]] == 0.0).all()


def test_the_common_turn_of_two_bodies_is_known_to_round_off() -> None:
    """Both sides of the switch from the quotient to its series: s = atan(y)/y / (1 + chi_a chi_b/4)."""
    for start in (-2.0, -0.05, 0.0, 0.3, 1.0):
        for apart in (1e-9, 0.01, 0.0999, 0.1001):
            bodies = zeros(2, kind_of(BodyStep))
            bodies[0].way[2], bodies[1].way[2] = start, start + apart
            for one in bodies:
                one.turned = 2.0 * math.atan(0.5 * one.way[2])
            product = 1.0 + 0.25 * start * (start + apart)
            y = 0.5 * (bodies[1].way[2] - start) / product
            most = 5e-16 if apart < 0.1 else 1e-14
            assert abs(shared_turn(bodies[0], bodies[1]) * product * y / math.atan(y) - 1.0) <= most


def test_forces_between_points_keep_angular_momentum() -> None:
    # Total angular momentum over the step: sum of x_m x F + torque, with x_m the centres at mid-way.
    one = Iterate(0.4)
    for k in (0, 1, 3, 4):  # a pivot's acts at two points if these are apart, as here
        force = one.at(k)[0].force
        middle = one.local["pose"][:, :2] + 0.5 * one.way[:, :2]
        moment = sum(middle[i, 0] * force[3 * i + 1] - middle[i, 1] * force[3 * i] + force[3 * i + 2] for i in (0, 1))
        assert abs(moment) < 1e-14
        np.testing.assert_allclose(force[:2], -force[3:5], atol=1e-15)


@pytest.mark.parametrize("order", [2, 4])
def test_condensed_components_step_as_full_ones(order: int) -> None:
    # The five parts of a step of order 4 share the factors of a condensed system.
    ends = []
    for wide in (False, True):
        space = linkages.cloth(5)
        stepper = Driven(space, order)
        arrange(stepper, wide)
        for _ in range(20):
            stepper.step(1 / 120)
        assert stepper.status == 0
        ends.append(np.array([tuple(b.position) for b in space.bodies]))
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-10)


def test_round_off_of_stiff_springs_ends_iterations() -> None:
    """Rings on pivots and springs fly: each of their steps takes the same few iterations with one factorisation. Errors
    of 3e-15 are round-off there; where that is not seen, some steps take five."""
    stepper, works = ep.EECA(program_joints.rings_of_planks().space), list[float]()
    for _ in range(8):
        stepper.step(1 / 60)
        assert stepper.event_loop is not None
        works.append(float(stepper.event_loop.joints.PROGRESS.effort))
    assert max(works) <= 1.1 * min(works)


def arrange(stepper: Driven, condensed: bool) -> None:
    """Have the stepper's only component in the bodies' unknowns alone, or not."""
    J, loop = stepper.joints, stepper.stepper.event_loop
    assert loop is not None
    order_unknowns(J, 0, condensed)
    C = J.COMPONENT[0]
    loop.joints = J._replace(
        RIGHT=np.zeros(2 * C.unknowns + C.impulses), MATRIX=np.zeros(C.unknowns * (3 * C.band + 1)),
        MORE=np.zeros(C.unknowns), PIVOTS=np.zeros(2 * C.unknowns, np.int64),
    )  # fmt: skip


@pytest.mark.parametrize("idle", [False, True], ids=["spring", "idle limit"])
def test_rows_have_one_scale_in_a_step_whatever_joint_comes_first(idle: bool) -> None:
    """Also of the parts of a step of order 4: factors that are used again have it."""
    found = []
    for first in (True, False):
        space = empty()
        rod = body(space, 1.0, 0.1, (1.0, 0.0), 0.0)
        rod.angular_velocity, rod.velocity = 3.0, (0.0, 3.0)
        other: pymunk.Constraint = pymunk.DampedSpring(space.static_body, rod, (0, 0), (0, 0), 1.0, 1.0, 0.0)
        if idle:
            other = pymunk.RotaryLimitJoint(space.static_body, rod, -9.0, 9.0)
        pin = pymunk.PinJoint(space.static_body, rod, (0.0, 0.0), (0.3, 0.2))
        space.add(*((other, pin) if first else (pin, other)))
        driven = Driven(space, 4)
        driven.step(0.1)
        found.append(float(driven.joints.HINGE["scale"][1 if first else 0, 0]))
    assert found[0] == pytest.approx(found[1], rel=1e-14)


def linked() -> pymunk.Space:
    """A chain of pivots and pins with a branch, a closed loop, a gear and limits that are met; no springs or motors."""
    space = linkages.chain(6, lean=0.4)
    links = [b for b in space.bodies if b is not space.static_body]
    side = body(space, 0.5, 0.2, (2.7, 0.9), 0.2)
    space.add(
        pymunk.PinJoint(links[2], side, (0.1, 0.1), (0.0, -0.2)),
        pymunk.PinJoint(links[3], side, (0.0, 0.1), (0.1, 0.0)), pymunk.RotaryLimitJoint(links[0], links[1], -0.2, 0.3),
        pymunk.GearJoint(links[4], links[5], 0.0, 2.0),
        pymunk.SlideJoint(space.static_body, links[5], links[5].position, (0.0, 0.0), 0.0, 0.4),
    )  # fmt: skip
    return space


def test_all_systems_step_an_island_alike() -> None:
    ends = []
    for dual_for in (UNUSED, STEPS):
        space = linked()
        stepper = Driven(space)
        assert stepper.joints.COMPONENT[0].dual_for == STEPS
        stepper.joints.COMPONENT[0].dual_for = dual_for
        for _ in range(60):
            stepper.step(1 / 60)
            assert stepper.status <= 1
        ends.append(np.array([tuple(b.position) for b in space.bodies]))
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-9)
