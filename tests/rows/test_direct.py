"""The parts of the solver one by one: the local law, the sparse factor, direct solutions."""

from __future__ import annotations

import numpy as np
import pytest

from eeca_pymunk.model.contacts import Problem
from eeca_pymunk.model.parameters.joints import COLUMN_CONTACTS
from eeca_pymunk.rows.active_set import divide_friction
from eeca_pymunk.rows.build import normal_rate, rates, tangent_rate
from eeca_pymunk.rows.cholesky import assemble_blocks, factor_blocks, make_factor, solve_blocks
from eeca_pymunk.rows.columns import as_columns
from eeca_pymunk.rows.coulomb import coulomb
from eeca_pymunk.rows.dense import solve_dense
from eeca_pymunk.rows.direct import solve_jointed
from eeca_pymunk.rows.dissection import dissect, neighbours
from eeca_pymunk.rows.sparse import solve_sparse
from eeca_pymunk.rows.sweeps import sweep, velocities

from .block import Block


@pytest.mark.parametrize("seed", range(200))
def test_local_law_holds_for_one_contact(seed: int) -> None:
    """Sticking, slipping against the slip, or friction at the bound of its energy; never a gain."""
    rng = np.random.default_rng(seed)
    ann, att = np.exp(rng.normal(size=2))
    mu, ant = np.exp(rng.normal()), rng.uniform(-1, 1) * np.sqrt(ann * att)
    un, ut, e = -abs(rng.normal()), rng.normal(), rng.choice([0.0, 0.5, 1.0])
    target = -e * un
    # Without its own impulse the contact moves as before, but for what others push.
    qn, qt = un - target + 0.3 * rng.normal(), ut + rng.normal()
    if qn >= 0.0:
        return
    lam, beta = coulomb(qn, qt, ann, ant, att, mu, un, ut, target)
    normal, slip = target + qn + ann * lam + ant * beta, qt + ant * lam + att * beta
    loss = -0.5 * lam * (un + target) - 0.5 * beta * (ut + slip)
    assert lam >= 0
    assert abs(beta) <= mu * lam * (1 + 1e-12)
    assert loss >= -1e-12
    if lam > 0:
        assert normal == pytest.approx(target, abs=1e-12)
        sticks, slips = abs(slip) <= 1e-12, abs(beta) >= mu * lam * (1 - 1e-12) and beta * slip <= 1e-12
        jammed = beta == 0.0 and abs(ant) * mu > ann
        assert sticks or slips or jammed or (loss <= 1e-12 and beta * ut > 0) or (beta == 0.0 and e == 1.0)


def test_jammed_contact_sticks() -> None:
    """Painleve: where slipping on would press ever deeper, the impulse is that of sticking."""
    for qt in (1.0, -1.0):
        ant = 0.9 * qt
        lam, beta = coulomb(-1.0, qt, 1.0, ant, 4.0, 8.0, -1.0, qt, 0.0)
        assert -1.0 + lam + ant * beta == pytest.approx(0.0, abs=1e-14)
        assert qt + ant * lam + 4.0 * beta == pytest.approx(0.0, abs=1e-14)


def crowd(seed: int, count: int) -> Block:
    rng = np.random.default_rng(seed)
    points = np.array([(2.0 * i, 2.0 * j) for i in range(count) for j in range(count)])
    return Block.disks(points, rng.normal(size=(count**2, 3)), np.exp(rng.normal(size=count**2)), np.ones(count**2))


def test_bodies_at_nearly_one_place_are_all_eliminated_once() -> None:
    """Where they differ by one unit of round-off, their mean may be no smaller than the greatest."""
    n, rng = 12, np.random.default_rng(0)
    start, other = neighbours(np.array([(i, i + 1) for i in range(n - 1)]), n - 1, n)
    for x in np.array([0.1, 1e3, 1e5, 1e9]) / 7.0:
        for _ in range(20):
            poses, place = np.zeros((n, 3)), np.empty(n, np.int64)
            poses[:, 0] = np.where(rng.random(n) < 0.3, np.nextafter(x, np.inf), x)
            dissect(poses, n, start, other, place)
            assert sorted(place) == list(range(n))


@pytest.mark.parametrize("count", [2, 5, 9])
def test_sparse_factor_is_that_of_the_dense_matrix(count: int) -> None:
    """B^-1 f against numpy, with a body that touches all others eliminated last."""
    block = crowd(1, count)
    n = count**2
    block.contacts += [(0, k, 0.6, 0.8, 0.1 * k, -0.2) for k in range(1, n)]
    block.solve(0.5, 0.5)
    m, k = len(block.contacts), n + 1
    held, stuck = np.ones(m, np.int64), (np.arange(m) % 2).astype(np.int64)
    scale = np.sqrt(np.stack((block.im, block.im, block.ii), axis=1))
    problem, R = Problem(block.rows, block.im, block.ii, block.pose, n, m), 100.0
    factor = make_factor(problem, held)
    assert np.array_equal(factor.SCALE, scale)
    place = factor.place
    assert sorted(place) == list(range(n))
    assemble_blocks(problem, held, stuck, R, factor)
    dense = np.eye(3 * n)
    for i in range(m):
        for rate, column in ((normal_rate, "k_n"), (tangent_rate, "k_t")):
            if rate is tangent_rate and not stuck[i]:
                continue
            j = np.zeros(3 * k)
            for p in range(3 * k):
                unit = np.zeros((k, 3))
                unit.flat[p] = 1.0
                j[p] = rate(block.rows[i], unit)
            j = (j.reshape(k, 3) * scale)[:n].ravel()
            dense += R * block.rows[column][i] * np.outer(j, j)
    right = np.random.default_rng(0).normal(size=(n, 3))
    f = np.empty((n, 3))
    f[place] = right
    factor_blocks(factor)
    solve_blocks(factor, f)
    expected = np.linalg.solve(dense, right.ravel()).reshape(n, 3)
    assert np.abs(f[place] - expected).max() <= 1e-11 * np.abs(expected).max()


@pytest.mark.parametrize("dense", [False, True])
@pytest.mark.parametrize("sliding", [False, True])
def test_direct_solution_needs_no_sweeps(dense: bool, sliding: bool) -> None:
    """A box pressed to the floor at two corners, sticking or sliding: redundant rows, known forces."""
    mu, h, g = 0.3, 0.01, 10.0
    pull = 0.5 if sliding else 0.2
    # All turned by an angle, about the box's centre.
    c, d = np.cos(0.5), np.sin(0.5)
    turn = np.array([[c, -d], [d, c]])
    block = Block(np.zeros((2, 3)), np.zeros((2, 3)), np.array([1.0, 0]), np.array([6.0, 0]))
    block.contacts = [(0, 1, *(turn @ [0.0, -1.0]), *(turn @ [x, -0.5])) for x in (-0.5, 0.5)]
    block.solve(0.0, mu)
    block.rows["target"] = 0.0
    rates(block.rows, block.velocity, 2)
    free = np.zeros((2, 3))
    free[0, :2] = turn @ [g * h * pull, -g * h]
    # A guess whose active contacts are right: friction on the floor is positive.
    part = mu if sliding else 0.1
    L, V = np.array([[0.03, part * 0.03], [0.03, part * 0.03]]), free.copy()
    problem = Problem(block.rows, block.im, block.ii, block.pose, 1, 2)
    velocities(problem, L, free, V)
    if dense:
        reached, _ = solve_dense(problem, L, V, free, 4, 1e-16, False)
    else:
        reached, _ = solve_sparse(problem, L, V, free, 1e8, 40, 1e-16)  # fmt: skip
    if dense or not sliding:
        assert reached <= 1e-14
        assert np.abs(V[0, :2] - turn @ [g * h * max(pull - mu, 0.0), 0.0]).max() <= 1e-14
        assert abs(V[0, 2]) <= 1e-14
        assert sweep(problem, L, V) <= 1e-14
        assert L[:, 0].sum() == pytest.approx(g * h, rel=1e-13)


def test_points_of_a_face_share_their_friction_as_their_loads() -> None:
    """A guess with one point at its cone's edge and the other pulling against it: the face as a whole sticks."""
    mu, g_h = 0.5, 0.1
    block = Block(np.zeros((2, 3)), np.zeros((2, 3)), np.array([1.0, 0]), np.array([6.0, 0]))
    block.contacts = [(0, 1, 0.0, -1.0, x, -0.5) for x in (-0.5, 0.5)]
    block.solve(0.0, mu)
    block.rows["target"] = 0.0
    free = np.array([[0.0, -g_h, 0.0], [0.0, 0.0, 0.0]])
    L = np.array([[0.04, -mu * 0.04], [0.03, 0.6 * mu * 0.03]])
    V = free.copy()
    problem = Problem(block.rows, block.im, block.ii, block.pose, 1, 2)
    velocities(problem, L, free, V)
    before, total = V.copy(), L[:, 1].sum()
    divide_friction(block.rows, L, 2)
    assert L[:, 1].sum() == pytest.approx(total, rel=1e-15)
    assert L[0, 1] / L[0, 0] == pytest.approx(L[1, 1] / L[1, 0], rel=1e-14)
    velocities(problem, L, free, V)
    assert np.abs(V - before).max() <= 1e-16
    reached, clamped = solve_sparse(problem, L, V, free, 1e8, 40, 1e-16)  # fmt: skip
    assert reached <= 1e-15
    assert clamped == 0
    assert np.abs(V[0]).max() <= 1e-15


@pytest.mark.parametrize(("count", "solved"), [(5, True), (6, False)])
def test_contacts_that_a_dense_solution_is_too_expensive_for_are_left_to_sweeps(count: int, solved: bool) -> None:
    """Columns of disks that fall on the ground as one: 25 contacts are solved at once. The factor of 300, of a wall of
    boxes that a ball on a chain hits, had taken four times a whole step."""
    block = crowd(0, count)
    block.contacts, n = [], count * count
    for k in range(n):
        block.contacts.append((k, n, 0.0, -1.0, block.pose[k, 0], block.pose[k, 1] - 1.0))
    block.contacts += [(k, k + 1, 1.0, 0.0, *block.pose[k, :2]) for k in range(n - 1)] if count == 6 else []
    block.solve(0.0, 0.0)
    m = len(block.contacts)
    block.rows["target"][:] = 0.0
    free = np.zeros_like(block.velocity)
    free[:n, 1] = -1.0
    L, V = np.full((m, 2), 0.1) * (1.0, 0.0), free.copy()
    problem = as_columns(Problem(block.rows, block.im, block.ii, block.pose, n, m))
    velocities(problem, L, free, V)
    before = L.copy()
    reached, _ = solve_jointed(problem, L, V, free, 0.0, 4, 1e-15)
    if solved:
        assert reached <= 1e-12
        assert np.abs(V[:n, 1]).max() <= 1e-12
    else:
        assert m > COLUMN_CONTACTS
        assert reached == np.inf
        assert np.array_equal(L, before)
