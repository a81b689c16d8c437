"""The matrix of a contact whose bodies joints guide."""

from __future__ import annotations

import math

import numpy as np
import pymunk
import pytest

import eeca_pymunk as ep
from eeca_pymunk.compiled.records import zeros
from eeca_pymunk.jointed.columns import set_effective_masses
from eeca_pymunk.jointed.groups import Groups, find_groups
from eeca_pymunk.model.contacts import ROW, Columns
from eeca_pymunk.model.parameters.joints import STRUT_BETWEEN
from eeca_pymunk.rows.coulomb import coulomb


@pytest.mark.parametrize("mass", [1e-3, 1.0, 1e4])
@pytest.mark.parametrize("slope", [0.01, 0.3, 1.5])
@pytest.mark.parametrize("error", [0.0, 1e-3 * STRUT_BETWEEN, -1e-3 * STRUT_BETWEEN, 0.1])
def test_what_joints_guide_on_a_line_does_not_stick_by_impulses_without_bound(
    error: float, slope: float, mass: float
) -> None:
    """A body slides on a line at an angle to a wall that moves along n, so that there are no impulses by which it would
    stick: A = d d^T / m but for an `error` of the response. By an elastic impact u_n is reversed: lam = -2 u_n / A_nn
    without friction, no more than 1 / (1 - mu |A_nt| / A_nn) times as much with it."""
    rows, d = zeros(1, ROW), (math.sin(slope), math.cos(slope))  # along n = (1, 0) and t = (0, 1)
    row = rows[0]
    row.a, row.nx, row.k_n, row.k_t, row.friction = 1, 1.0, mass, mass, 0.5 * d[0] / d[1]
    N, T = np.zeros((1, 3)), np.zeros((1, 3))
    N[0, :2] = d[0] * d[0] / mass, d[0] * d[1] / mass
    T[0, :2] = d[1] * d[0] / mass, (d[1] * d[1] + error) / mass
    one, none = np.array([0]), np.zeros(0, np.int64)
    C = Columns(np.array([0, 1]), one, N, T, np.zeros(1, np.int64), np.zeros(1))
    groups = Groups(np.array([0, -1]), np.array([0, 1]), one, one, none, np.array([STRUT_BETWEEN]))
    set_effective_masses(groups, C, rows, 1)
    assert C.LEFT_OUT[0] == 0
    assert row.a_nn == pytest.approx(d[0] ** 2 / mass, rel=1e-12)
    assert math.isnan(row.w_nn) == (abs(error) < STRUT_BETWEEN)
    un, ut = -d[0] - 0.3, -d[1]
    lam, beta = coulomb(2.0 * un, ut, row.a_nn, row.a_nt, row.a_tt, row.friction, un, ut, -un)
    assert abs(beta) <= row.friction * lam * (1.0 + 1e-12)
    if abs(error) < STRUT_BETWEEN:
        assert lam * row.a_nn <= -2.0 * un * 2.0 * (1.0 + 1e-9)
        assert row.a_nn * lam + row.a_nt * beta == pytest.approx(-2.0 * un, rel=1e-6)


@pytest.mark.parametrize("ratio", [10.0, 1e3, 1e4])
def test_a_light_body_that_heavy_ones_of_its_own_component_hold_is_hit(ratio: float) -> None:
    """A block that does not turn is pinned to a heavy one, m at a distance d from the pin with moment m d², and hit by
    another heavy one, which a weak spring makes part of the component: the blow moves 1/ratio of what the block by
    itself would. At the pin the other one meets 1 + 1/(1/m + d²/(m d²)) = 1 + m/2."""
    space, far = pymunk.Space(), 3.0
    heavy, light, other = (pymunk.Body(m, i) for m, i in ((ratio, ratio * far**2), (1.0, math.inf), (ratio, math.inf)))
    heavy.position, other.position, other.velocity = (0.0, far), (-2.0, 0.0), (1.0, 0.0)
    shapes = [pymunk.Circle(b, 0.5) for b in (light, other)]
    for shape in shapes:
        shape.elasticity = 1.0
    pin = pymunk.PivotJoint(heavy, light, (0.0, 0.0))
    space.add(heavy, light, other, *shapes, pin, pymunk.DampedRotarySpring(heavy, other, 0.0, 1e-9, 0.0))
    stepper = ep.EECA(space)
    for _ in range(90):
        report = stepper.step(1 / 60)
        assert report.converged, report.unmet
    met = 1.0 + 0.5 * ratio
    assert other.velocity.x == pytest.approx((ratio - met) / (ratio + met), rel=1e-9)


def test_springs_connect_bodies_within_an_interval_and_not_at_an_impact() -> None:
    """Three disks on springs and two on a pin: within an interval an impulse on one disk moves all three, at an impact
    it moves that disk alone, as a spring exerts no impulse at an instant. Columns of an impact on a net have entries
    for the bodies that it moves, not for all."""
    space = pymunk.Space()
    disks = [pymunk.Body(1.0, 1.0) for _ in range(5)]
    for k, disk in enumerate(disks):
        disk.position = 2.0 * k, 0.0
        space.add(disk, pymunk.Circle(disk, 0.5))
    for a, b in ((0, 1), (1, 2)):
        space.add(pymunk.DampedSpring(disks[a], disks[b], (0.0, 0.0), (0.0, 0.0), 2.0, 10.0, 0.1))
    space.add(pymunk.PinJoint(disks[3], disks[4]))
    stepper = ep.EECA(space)
    stepper.step(1e-3)
    loop = stepper.event_loop
    assert loop is not None
    who, mobile = np.arange(5), np.ones(5)
    within, at_impact = (find_groups(who, mobile, loop.joints, impact) for impact in (False, True))
    assert within.GROUP.tolist() == [0, 0, 0, 1, 1]
    assert at_impact.GROUP.tolist() == [0, 1, 2, 3, 3]
    assert (at_impact.COMPONENT >= 0).tolist() == [False, False, False, True]
    assert len(at_impact.JOINTED) == 1
