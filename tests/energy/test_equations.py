"""The EECA equations against closed forms, the paper's numbers and the balance itself."""

from __future__ import annotations

import numpy as np
import pytest

import eeca_pymunk as ep
import scenes
from comparisons.cradle import slopes
from comparisons.signorini import closed_form
from eeca_pymunk.energy import balance
from eeca_pymunk.energy.delassus import Delassus, islands

from ..steppers import CLOSURES, two_disks

RATIOS = [0.0, 0.5, 1.0, 5.0, 20.0, 80.0, 160.0]


@pytest.mark.parametrize("ratio", RATIOS)
def test_signorini_closed_form(ratio: float) -> None:
    scene = scenes.build("signorini")
    report = ep.EECA(scene.space, ep.Dashpot(scene.stiffness, ratio)).step(scene.dt)
    increment, psi1, psi2 = closed_form(ratio, scene.dt, scene.stiffness)
    assert report.gap_increment[0] == pytest.approx(increment, abs=1e-12)
    assert report.psi1[0] == pytest.approx(psi1, abs=1e-12, rel=1e-12)
    assert report.psi2[0] == pytest.approx(psi2, abs=1e-12)
    # The gap that the motion makes is the gap of the equations.
    assert scene.bodies[0].position.y - 0.1 == pytest.approx(increment, abs=1e-15)
    assert scene.bodies[0].velocity == (0.0, 1.0)
    # Total contact force of Fig. 5: constant, 2 m v / dt.
    assert report.impulse[0] / scene.dt == pytest.approx(1000.0, rel=1e-14)


def test_signorini_without_dashpot_is_the_golden_ratio() -> None:
    # Omega = 2: delta² - delta - 1 = 0.
    scene = scenes.build("signorini")
    report = ep.EECA(scene.space, ep.Dashpot(scene.stiffness, 0.0)).step(scene.dt)
    assert report.psi2[0] == pytest.approx((1 - np.sqrt(5)) / 2, abs=1e-14)


@pytest.mark.parametrize("gap", [-1e-3, -1e-4, 0.0, 1e-4])
@pytest.mark.parametrize("ratio", RATIOS)
def test_weights_satisfy_balance_and_contact_force(gap: float, ratio: float) -> None:
    K, dt, mass = 1e6, 1e-3, np.array([2.0])
    S = balance.dashpot_sum(ratio, balance.reduced_frequency(K, mass, dt))
    lam, w = np.array([6.0]), np.array([12.0])
    found = balance.weights(lam, np.array([gap]), w, S, K, dt)
    g_n = min(gap, 0.0)
    assert found.psi1 + found.psi2 == pytest.approx(S, rel=1e-14)  # Eq. 28
    if abs(found.psi2[0]) < 1.0:  # else clamped
        force = -0.5 * K * (2 * g_n + found.gap_increment) - 0.5 * found.psi1 * K * found.gap_increment  # Eqs. 11, 12
        assert force == pytest.approx(lam / dt, rel=1e-11)
    assert lam * found.gap_increment / dt == pytest.approx(0.5 * found.psi2 * w, rel=1e-13)  # Eq. 20


def test_weights_of_open_contacts_vanish() -> None:
    S = np.array([3.0])
    found = balance.weights(np.zeros(1), np.array([-1e-3]), np.ones(1), S, 1e6, 1e-3)
    assert (found.psi1[0], found.psi2[0], found.gap_increment[0]) == (3.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("ratio", "expected"),
    [
        (200.0, (-0.33332, 0.67046, 0.66286)),  # psi1 + psi2 = 4 xi / Omega, Eq. 28 as printed
        (100.0, (-0.33328, 0.67423, 0.65904)),  # psi1 + psi2 = 2 xi / Omega: the digits the paper's table shows
    ],
)
def test_table_iii_simultaneous(ratio: float, expected: tuple[float, float, float]) -> None:
    # The paper's Table III prints (-.3332, .674, .659), which its Eq. 28 gives at half the damping ratio.
    scene = scenes.build("cradle", hypothesis="i")
    ep.EECA(scene.space, ep.Dashpot(scene.stiffness, ratio)).step(scene.dt)
    assert [b.velocity.x for b in scene.bodies] == pytest.approx(expected, abs=1e-5)
    assert ep.measure(scene.space).energy == pytest.approx(0.5, rel=1e-14)


@pytest.mark.parametrize("closure", CLOSURES.values(), ids=CLOSURES.keys())
def test_table_iii_sequential(closure: ep.Closure) -> None:
    scene = scenes.build("cradle", hypothesis="ii")
    stepper = ep.EECA(scene.space, closure)
    for _ in range(40):
        stepper.step(scene.dt)
    assert [b.velocity.x for b in scene.bodies] == pytest.approx((0.0, 0.0, 1.0), abs=1e-12)


def test_midstep_is_the_simultaneous_law() -> None:
    scene = scenes.build("cradle", hypothesis="i")
    ep.EECA(scene.space, ep.Midstep()).step(scene.dt)
    assert [b.velocity.x for b in scene.bodies] == pytest.approx((-1 / 3, 2 / 3, 2 / 3), abs=1e-14)


@pytest.mark.parametrize("stiffness", [1e5, 1e6, 1e7])
@pytest.mark.parametrize("variable", ["dt", "xi"])
def test_cradle_error_orders(stiffness: float, variable: str) -> None:
    # Both errors are powers of 1 / (xi Omega); the paper's text has them fall with dt, its equations do not.
    of_a, of_bc = slopes(stiffness, variable)
    assert of_a == pytest.approx(-2.0, abs=0.05)
    assert of_bc == pytest.approx(-1.0, abs=0.05)


@pytest.mark.parametrize("ratio", [0.0, 200.0])
@pytest.mark.parametrize("stiffness", [1e4, 1e6])
def test_oblique_hit_keeps_angular_momentum(ratio: float, stiffness: float) -> None:
    space, bodies = two_disks()
    stepper = ep.EECA(space, ep.Dashpot(stiffness, ratio))
    hits = 0
    for _ in range(60):
        before = ep.measure(space)
        hits += len(stepper.step(2.5e-3).contacts)
        now = ep.measure(space)
        assert now.angular_momentum == pytest.approx(before.angular_momentum, abs=1e-14)
        assert now.energy == pytest.approx(before.energy, rel=1e-14)
        np.testing.assert_allclose(now.linear_momentum, before.linear_momentum, atol=1e-15)
    assert hits > 0
    assert bodies[0].velocity.x < bodies[1].velocity.x


def test_lock_makes_any_impulse_conservative() -> None:
    rng = np.random.default_rng(3)
    m_inv = np.array([1.0, 0.5, 0.2, 0.0])
    row_a, row_b = np.array([0, 1, 0]), np.array([1, 2, 3])
    angle = rng.uniform(0, 6.28, 3)
    A = Delassus(row_a, row_b, np.stack((np.cos(angle), np.sin(angle)), 1), m_inv)
    v, F = rng.normal(size=(4, 2)), 0.01 * rng.normal(size=(4, 2))
    v[3] = F[3] = 0.0
    psi2, lam = np.array([0.3, -0.2, 0.1]), rng.uniform(0.5, 1.0, 3)
    u = A.relative(v)
    lam[:] = np.where(u < 0, lam, 0.01 * lam)
    q = 2 * u + A.relative(F * m_inv[:, None])
    lock = balance.energy_lock(A, islands(row_a, row_b, m_inv), lam, q, psi2, F)
    assert lock.valid.all()
    J = A.impulse(lock.scale * lam)
    P = balance.extra_momentum(A, psi2, F + J) * m_inv[:, None]
    half = v + 0.5 * (F + J) * m_inv[:, None]
    # Kinetic energy gained, less the work of the external force along the displacement dt (v_1/2 + P).
    change = np.sum((F + J)[:3] * half[:3]) - np.sum(F[:3] * (half + P)[:3])
    assert abs(change) < 1e-14
    assert abs(lock.scale[0] - 1.0) > 1e-3  # the impulses did need it


def test_islands_stop_at_walls() -> None:
    row_a, row_b = np.array([0, 1, 2, 3]), np.array([1, 4, 4, 5])
    label = islands(row_a, row_b, np.array([1.0, 1.0, 1.0, 1.0, 0.0, 1.0]))
    assert label[0] == label[1]
    assert len(set(label.tolist())) == 3
