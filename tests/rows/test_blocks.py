"""Simultaneous impacts: known answers, symmetry, conservation, and an independent solver."""

from __future__ import annotations

import math
from random import Random

import numpy as np
import pytest
from scipy.optimize import nnls

from eeca_pymunk.model.contacts import Problem
from eeca_pymunk.rows.blocks import CONVERGED, solve_frictionless
from eeca_pymunk.rows.build import normal_rate

from .block import Block, Floats

UNITS = [1e-3, 1.0, 1e3]


def at(*points: tuple[float, float]) -> Floats:
    return np.array(points, dtype=float)


def check_books(block: Block, single: float = 1e-14, tolerance: float = 1e-14) -> None:
    """The ledger closes, no contact gives energy, momentum is kept where nothing touches the ground.

    A single contact's loss has the sign of its law as far as that is solved: friction to `single`.
    """
    n = len(block.pose) - 1
    before, after = block.energy(block.velocity), block.energy(block.after)
    assert abs(after - before + block.out[0].restitution + block.out[0].friction) <= tolerance * before
    assert block.loss.min(initial=0.0) >= -single * before
    if max((b for _, b, *_ in block.contacts), default=0) < n:
        momentum = ((block.after - block.velocity)[:n, :2] / block.im[:n, None]).sum(axis=0)
        assert np.abs(momentum).max() <= tolerance * np.abs(block.velocity[:n, :2] / block.im[:n, None]).sum()


@pytest.mark.parametrize("unit", UNITS)
def test_cradle_of_touching_disks_shares_the_impact(unit: float) -> None:
    block = Block.disks(unit * at((0, 0), (2, 0), (4, 0)), at((1, 0), (0, 0), (0, 0)), np.ones(3), unit * np.ones(3))
    block.solve(1.0, 0.0)
    assert block.status == CONVERGED
    assert np.abs(block.after[:3, 0] - [-1 / 3, 2 / 3, 2 / 3]).max() <= 1e-14
    check_books(block)


@pytest.mark.parametrize(("e", "expected"), [(0.0, 0.4), (0.5, 0.1), (1.0, -0.2)])
def test_disk_onto_two_touching_ones(e: float, expected: float) -> None:
    """Scene of SCISim: v1'/v = .4, .1, -.2, symmetric."""
    high = math.sqrt(3) / 2
    block = Block.disks(at((0, 0), (high, 0.5), (high, -0.5)), at((1, 0), (0, 0), (0, 0)), np.ones(3), np.full(3, 0.5))
    block.solve(e, 0.0)
    assert block.after[0, 0] == pytest.approx(expected, abs=2e-15)
    assert np.abs(block.after[1, :2] - block.after[2, :2] * [1, -1]).max() <= 2e-15
    check_books(block)


def test_corner_reverses_a_disk() -> None:
    block = Block.disks(at((0, 0)), at((3, -2)), np.ones(1), np.ones(1))
    block.wall(0, (1.0, 0.0), 1.0)
    block.wall(0, (0.0, -1.0), 1.0)
    block.solve(1.0, 0.0)
    assert np.abs(block.after[0] - [-3, 2, 0]).max() <= 1e-15


@pytest.mark.parametrize("e", [0.0, 0.7, 1.0])
def test_box_on_two_corners(e: float) -> None:
    """A box that lands flat bounces flat, whatever its moment: the row of both corners is redundant in rotation."""
    pose = np.array([[0, 0, 0], [0, 0, 0]], float)
    block = Block(pose, np.array([[0.3, -2.0, 0], [0, 0, 0]]), np.array([0.5, 0]), np.array([7.0, 0]))
    block.contacts = [(0, 1, 0.0, -1.0, -1.0, -0.5), (0, 1, 0.0, -1.0, 1.0, -0.5)]
    block.solve(e, 0.0)
    assert np.abs(block.after[0] - [0.3, 2 * e, 0]).max() <= 2e-14
    assert np.abs(block.impulses[:, 0] - 2 * (1 + e)).max() <= 1e-13


def rack(rows: int) -> Block:
    """A disk hits the tip of a triangle of touching disks: redundant contacts, and 18 angles of 60 degrees."""
    points = [(-2.0, 0.0)] + [(math.sqrt(3) * i, 2.0 * j - i) for i in range(rows) for j in range(i + 1)]
    velocity = np.zeros((len(points), 2))
    velocity[0, 0] = 1.0
    return Block.disks(np.array(points), velocity, np.ones(len(points)), np.ones(len(points)))


def mirrored(block: Block) -> Floats:
    """Velocities after, of the mirror images in y."""
    n = len(block.pose) - 1
    image = [int(np.argmin(np.hypot(*(block.pose[:n, :2] - p * [1, -1]).T))) for p in block.pose[:n, :2]]
    mirror: Floats = block.after[image] * [1, -1, -1]
    return mirror


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_rack_breaks_symmetrically(e: float) -> None:
    block = rack(10)
    block.solve(e, 0.0)
    assert block.status == CONVERGED
    assert np.abs(block.after[:-1] - mirrored(block)).max() <= 1e-14
    check_books(block)


@pytest.mark.parametrize("mu", [0.05, 0.3])
def test_rack_with_friction_keeps_its_books(mu: float) -> None:
    block = rack(6)
    block.solve(0.9, mu)
    assert np.abs(block.after[:-1] - mirrored(block)).max() <= 1e-5
    check_books(block, 1e-8)


def test_square_of_four_disks_hit_in_the_middle() -> None:
    """Four touching disks in a square: the matrix is singular; the answer has both mirror symmetries."""
    points = at((-1, -1), (1, -1), (1, 1), (-1, 1))
    block = Block.disks(points, -points, np.ones(4), np.ones(4))
    block.solve(1.0, 0.0)
    assert block.status == CONVERGED
    assert np.abs(block.after[:4, :2] - points).max() <= 1e-14


@pytest.mark.parametrize(("count", "e", "mass"), [(300, 0.5, 1.0), (300, 1.0, 1.0), (300, 1.0, 1e3), (1000, 0.5, 1e3)])
def test_hundreds_of_contacts_on_one_body(count: int, e: float, mass: float) -> None:
    angle, radius = 2 * np.pi * np.arange(count) / count, 3.0 / count
    points = np.concatenate((np.zeros((1, 2)), (1.0 + radius) * np.stack((np.cos(angle), np.sin(angle)), axis=1)))
    rng = np.random.default_rng(5)
    block = Block.disks(
        points, rng.normal(size=(count + 1, 2)), np.append(mass, np.ones(count)), np.append(1.0, np.full(count, radius))
    )
    assert len(block.contacts) == count
    block.solve(e, 0.0)
    assert block.status == CONVERGED
    check_books(block)


def reference(block: Block, e: float) -> Floats:
    """Velocities by non-negative least squares: min |C^T lam + d| in the metric of the masses (dual of the law)."""
    n = len(block.pose) - 1
    G = np.zeros((len(block.contacts), 3 * n))
    for i, (a, b, nx, ny, px, py) in enumerate(block.contacts):
        for body, sign in ((a, -1.0), (b, 1.0)):
            if body < n:
                x, y = px - block.pose[body, 0], py - block.pose[body, 1]
                G[i, 3 * body : 3 * body + 3] = sign * nx, sign * ny, sign * (x * ny - y * nx)
    root = np.sqrt(np.stack((block.im[:n], block.im[:n], block.ii[:n]), axis=1).ravel())
    v = block.velocity[:n].ravel()
    u = G @ v
    q = u - np.where(u < 0, -e * u, -u)
    # 0 <= lam _|_ A lam + q with A = C C^T, q = C d (d exists also where A is singular if the law has a solution).
    C = G * root
    d = np.linalg.lstsq(C, q, rcond=None)[0]
    lam, _ = nnls(C.T, -d)
    return (v + root * (C.T @ lam)).reshape(n, 3)


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("unit", UNITS)
def test_velocities_are_those_of_an_independent_solver(seed: int, unit: float) -> None:
    """Touching disks of random masses on a floor, and boxes' corners as contacts with arms; random velocities."""
    rng = np.random.default_rng(seed)
    side = 4
    points = np.array([(2.0 * i + (j % 2), math.sqrt(3) * j) for j in range(side) for i in range(side)])
    keep = rng.random(len(points)) < 0.8
    points = points[keep]
    n = len(points)
    block = Block.disks(
        unit * points, unit * rng.normal(size=(n, 3)), np.exp(rng.normal(size=n)), unit * np.ones(n), 1e-9
    )
    block.velocity[:n, 2] /= unit
    for i in np.flatnonzero(points[:, 1] == 0.0):
        block.wall(int(i), (0.0, -1.0), unit)
    # Shapes need not be disks: move every other point along its tangent, which gives normal impulses arms.
    block.contacts = [
        (a, b, nx, ny, px - 0.3 * unit * (k % 2) * ny, py + 0.3 * unit * (k % 2) * nx)
        for k, (a, b, nx, ny, px, py) in enumerate(block.contacts)
    ]
    e = float(rng.choice([0.0, 0.6, 1.0]))
    block.solve(e, 0.0)
    assert block.status == CONVERGED
    scale = unit * np.array([1.0, 1.0, 1 / unit])
    assert np.abs((block.after[:n] - reference(block, e)) / scale).max() <= 1e-11
    check_books(block)


@pytest.mark.parametrize("seed", range(6))
def test_friction_obeys_coulomb_and_the_books(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = np.array([(2.0 * i, 2.0 * j) for i in range(4) for j in range(3)])
    block = Block.disks(points, rng.normal(size=(12, 3)), np.exp(rng.normal(size=12)), np.ones(12))
    mu = float(rng.uniform(0.1, 1.0))
    block.solve(float(rng.uniform(0, 1)), mu)
    lam, beta = block.impulses.T
    assert (lam >= 0).all()
    assert (np.abs(beta) <= mu * lam * (1 + 1e-12)).all()
    check_books(block, 1e-8)


@pytest.mark.parametrize("mu", [0.1, 0.2, 0.4])
@pytest.mark.parametrize("e", [0.0, 0.7, 1.0])
def test_disk_on_a_wall_sticks_or_slips(e: float, mu: float) -> None:
    """Sticks iff |u| <= 3 mu (1 + e) v with p_t = -(m/3) u, else p_t = -mu (1 + e) m v sign u."""
    block = Block.disks(at((0, 0)), at((1.0, -1.0)), np.full(1, 2.0), np.full(1, 0.5))
    block.wall(0, (0.0, -1.0), 0.5)
    block.solve(e, mu)
    p = -2.0 / 3.0 if 3 * mu * (1 + e) >= 1.0 else -mu * (1 + e) * 2.0
    assert block.after[0, 0] == pytest.approx(1.0 + p / 2.0, abs=1e-15)
    assert block.after[0, 1] == pytest.approx(e, abs=1e-15)
    check_books(block)


def test_a_debt_is_paid_by_the_block() -> None:
    """An energy that forces have put in before is taken out together with the impact, exactly."""
    block = rack(4)
    block.solve(1.0, 0.0, owed=0.01)
    assert 0.5 < block.out[0].lock < 1.5
    assert block.energy(block.velocity) - block.energy(block.after) == pytest.approx(0.01, abs=1e-15)


def test_a_debt_too_large_is_paid_as_far_as_it_goes() -> None:
    block = Block.disks(at((0, 0), (2, 0)), at((1, 0), (0, 0)), np.ones(2), np.ones(2))
    block.solve(1.0, 0.0, owed=1.0)
    assert block.energy(block.velocity) - block.energy(block.after) == pytest.approx(0.25, abs=1e-15)


def test_what_separates_is_left_alone() -> None:
    block = Block.disks(at((0, 0), (2, 0)), at((-1, 0), (1, 0)), np.ones(2), np.ones(2))
    block.solve(1.0, 0.0)
    assert (block.after == block.velocity).all()
    assert block.out[0].residual == 0.0


@pytest.mark.parametrize("mu", [0.0, 0.5])
@pytest.mark.parametrize("approach", [1e-3, 1e-9, 1e-15])
def test_impact_in_a_fast_frame_converges(approach: float, mu: float) -> None:
    """Galilei: u_n is the same where all move by 100 more, but has the round-off of 100. The solve cannot do better."""
    rng = np.random.default_rng(7)
    for _ in range(50):
        angles, arms = rng.uniform(0, 2 * np.pi, 3), 0.5 + rng.random(3)
        for frame in (0.0, 100.0):
            block = Block(np.zeros((2, 3)), np.zeros((2, 3)), np.array([1.3, 0.0]), np.array([2.0, 0.0]))
            for angle, arm in zip(angles, arms, strict=True):
                x, y = math.cos(angle), math.sin(angle)
                block.contacts.append((0, 1, x, y, -arm * y, arm * x))
            block.velocity[:, :2] = frame * rng.normal(size=2)
            block.velocity[0, :2] += approach * at((math.cos(angles[0]), math.sin(angles[0])))[0]
            block.solve(0.5, mu)
            assert block.status == CONVERGED


def layers(n: int, high: int) -> Block:
    """`high` layers of n unit boxes side by side, each on two corners of its base and against two of its sides."""
    N = n * high
    pose = np.array([(k % n, 0.5 + k // n, 0.0) for k in range(N)] + [(0.0, 0.0, 0.0)])
    block = Block(pose, np.zeros((N + 1, 3)), np.append(np.ones(N), 0.0), np.append(np.full(N, 6.0), 0.0))
    for k in range(N):
        x, y = pose[k, :2]
        block.contacts += [(k, k - n if k >= n else N, 0.0, -1.0, x + side, y - 0.5) for side in (-0.5, 0.5)]
        if k % n + 1 < n:
            block.contacts += [(k, k + 1, 1.0, 0.0, x + 0.5, y + side) for side in (-0.5, 0.5)]
    return block


@pytest.mark.parametrize("mu", [0.2, 0.5])
def test_redundant_contacts_with_friction_converge(mu: float) -> None:
    """Boxes in layers share loads in many ways: impulses may go from contact to contact and change no velocity."""
    rng = np.random.default_rng(round(10 * mu))
    for _ in range(20):
        block = layers(4, 2)
        mass = 10.0 ** rng.uniform(0.0, 2.0, 8)
        block.im[:8] /= mass
        block.ii[:8] /= mass
        block.velocity[:8] = rng.normal(size=(8, 3)) * rng.choice([0.0, 1.0], size=(8, 1))
        block.solve(0.0, mu)
        assert block.status == CONVERGED
        check_books(block, 1e-8)


@pytest.mark.parametrize("seed", [37, 131])
def test_impulses_of_what_is_jammed_do_not_grow(seed: int) -> None:
    """Contacts that friction holds against each other have no solution: sweeps go on steadily, and change velocities.
    Taken at once, they gave impulses of 200 and 100 000 times the momentum, and books that were open by 3e-9."""
    R = np.random.default_rng(seed)
    pose, velocity = np.zeros((3, 3)), np.zeros((3, 3))
    velocity[:2], mass = R.normal(size=(2, 3)), 10.0 ** R.uniform(-2.0, 2.0, 2)
    pose[1, 0] = 1.0
    block = Block(pose, velocity, np.append(1 / mass, 0.0), np.append(1 / (0.3 * mass), 0.0))
    for a, b in ((0, 1), (0, 2), (1, 2), (0, 1)):
        angle, point = R.uniform(0.0, 2.0 * math.pi), R.uniform(-0.5, 1.5, 2)
        block.contacts.append((a, b, math.cos(angle), math.sin(angle), *point))
    block.solve(0.3, 1.0)
    assert np.abs(block.impulses).max() < 10.0 * mass.sum() * np.abs(velocity).max()
    lost = block.energy(velocity) - block.energy(block.after)
    assert lost >= 0.0
    assert block.loss.sum() == pytest.approx(lost, abs=1e-14 * block.energy(velocity))


def wedged(seed: int) -> Block:
    """Two flush bodies of which one may touch the ground by its end, or both; they spin fast, and rub elastically."""
    chance = Random(seed)
    mass = 10.0 ** chance.uniform(-1.0, 2.0)
    pose = np.array([[0.0, 0.0, 0.0], [chance.uniform(0.1, 0.5), chance.uniform(-1.0, 1.0), 0.0], [0.0, 0.0, 0.0]])
    rest = np.zeros(3)
    velocity = np.array([*([chance.uniform(-u, u) for u in (1.0, 1.0, 3.0)] for _ in range(2)), rest])
    turns = np.array([2.5 / mass, chance.uniform(1.0, 20.0), 0.0])
    block = Block(pose, velocity, np.array([1.0 / mass, 1.0, 0.0]), turns)
    y, half = pose[1, 1], chance.uniform(0.05, 0.5)
    block.contacts = [(0, 1, 1.0, 0.0, 0.05, y - half), (0, 1, 1.0, 0.0, 0.05, y + half)]
    if chance.random() < 0.5:
        block.contacts.append((0, 2, 0.0, -1.0, 0.0, -1.0))
    if chance.random() < 0.3:
        block.contacts.append((1, 2, 0.0, -1.0, pose[1, 0] + chance.uniform(-0.3, 0.3), y - half))
    block.solve(1.0, chance.choice((1.0, 0.5, 2.0)))
    return block


@pytest.mark.parametrize("seed", [313, 818, 1442, 2570, 2636])
def test_contacts_that_friction_wedges_part_without_it(seed: int) -> None:
    """With friction some approach although they should part, and would meet again at the same instant."""
    block = wedged(seed)
    m, n = len(block.contacts), len(block.pose) - 1
    fastest = max(-normal_rate(row, block.velocity) for row in block.rows)
    assert block.status != CONVERGED
    assert block.out[0].residual > 0.01 * fastest
    problem = Problem(block.rows, block.im, block.ii, block.pose, n, m)
    sweeps, direct = block.out[0].sweeps, block.out[0].direct
    status = solve_frictionless(
        problem, block.impulses, block.after, block.velocity, 0.0, block.status, False, block.out
    )
    assert status == CONVERGED
    assert block.out[0].sweeps > sweeps > 0  # the budget of a step pays for both
    assert block.out[0].direct >= direct > 0
    assert min(normal_rate(row, block.after) - row.target for row in block.rows) >= -1e-13 * fastest
    assert abs(block.energy(block.after) / block.energy(block.velocity) - 1.0) <= 1e-13
    assert (block.impulses[:, 1] == 0.0).all()


def test_contacts_that_the_energy_lock_leaves_without_impulses_part_without_friction() -> None:
    """Three contacts of bodies of 1 : 340 in mass, of which sweeps change little, by 3e-5 of the approach: yet they
    approach as before, as impulses that would gain energy are scaled to none (random scene 63012154)."""
    pose = np.array([
        [-0.07486102008389169, -0.1722963861233542, 1.2525514692968105],
        [-0.04858800889672171, -0.1444590703302089, 10.405845549297858],
        [-0.058049707697492715, -0.16556385188077952, -0.25907157803363684], [0.0, 0.0, 0.0],
    ])  # fmt: skip
    velocity = np.array([
        [0.15448073208955287, -0.07751426431938918, 3.5549267735630115],
        [0.32015181897549105, -0.2022504323983658, -12.024090285302295],
        [0.13145038832036807, -0.06960149704148107, 1.3576253880864049], [0.0, 0.0, 0.0],
    ])  # fmt: skip
    block = Block(
        pose, velocity, np.array([50.27945089599985, 0.1472313104028481, 5.228732124844611, 0.0]),
        np.array([1427198.2938935466, 963.4250451337974, 41872.82390338674, 0.0]),
    )  # fmt: skip
    block.contacts = [
        (0, 2, -0.1448909429713231, 0.9894476310775022, -0.06503021948818202, -0.16717303957877397),
        (1, 2, -0.9999943814914282, -0.0033521613290648416, -0.05945823335034388, -0.16070370675476112),
        (1, 2, 0.7540694800271702, -0.6567946553463669, -0.05945831627204663, -0.1607037070105151),
    ]
    block.solve(1.0, 1.0)
    fastest = max(-normal_rate(row, block.velocity) for row in block.rows)
    assert block.status != CONVERGED
    assert block.out[0].residual < 1e-3 * fastest
    assert min(normal_rate(row, block.after) - row.target for row in block.rows) < -0.5 * fastest
    problem = Problem(block.rows, block.im, block.ii, block.pose, len(pose) - 1, 3)
    solve_frictionless(problem, block.impulses, block.after, block.velocity, 0.0, block.status, False, block.out)
    assert min(normal_rate(row, block.after) - row.target for row in block.rows) >= -1e-10 * fastest
    assert abs(block.energy(block.after) / block.energy(block.velocity) - 1.0) <= 1e-13
