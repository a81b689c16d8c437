"""Coulomb's law and bounded impulses at the end of a homotopy, by the laws themselves."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from eeca_pymunk.compiled.records import zeros
from eeca_pymunk.model.contacts import BOUNDED_ROW, ROW, Bounded, Columns, JointedProblem
from eeca_pymunk.model.parameters.joints import HOMOTOPY_WORK, MATRIX_WORK
from eeca_pymunk.rows.bounded import FIRST_OF_DISC, SECOND_OF_DISC, room_for_rows, weigh_rows
from eeca_pymunk.rows.build import normal_rate, place_row, tangent_rate
from eeca_pymunk.rows.homotopy import follow_homotopy
from eeca_pymunk.rows.homotopy_start import work_of_change
from eeca_pymunk.rows.laws import solve_columns
from eeca_pymunk.rows.sweeps import push, sweep, velocities

Array = np.ndarray


def problem_of(
    pairs: list[tuple[int, int]], points: Array, normals: Array, places: Array, mu: float, rows: int = 0
) -> JointedProblem:
    """Bodies of unit mass and moment .1 at `places` (k, 2), the last of which does not move, that answer alone; the
    first `rows` of them turn against a motor of bounded torque."""
    m, k = len(pairs), len(places)
    pose = np.column_stack((places, np.zeros(k)))
    inverse, moments = np.ones(k), np.full(k, 10.0)
    inverse[-1] = moments[-1] = 0.0
    contacts = zeros(m, ROW)
    columns = Columns(
        2 * np.arange(m + 1), np.empty(2 * m, np.int64), np.empty((2 * m, 3)), np.empty((2 * m, 3)),
        np.zeros(m, np.int64), np.zeros(1),
    )  # fmt: skip
    for i in range(m):
        row, (row.a, row.b) = contacts[i], pairs[i]
        row.nx, row.ny, row.friction = normals[i, 0], normals[i, 1], mu
        place_row(row, points[i, 0], points[i, 1], pose, inverse, moments)
        for side, (body, sign) in enumerate(((row.a, -1.0), (row.b, 1.0))):
            arms = (row.arm_na, row.arm_ta) if side == 0 else (row.arm_nb, row.arm_tb)
            masses = np.array([inverse[body], inverse[body], moments[body]])
            columns.BODY[2 * i + side] = body
            columns.N[2 * i + side] = sign * masses * (row.nx, row.ny, arms[0])
            columns.T[2 * i + side] = sign * masses * (-row.ny, row.nx, arms[1])
    bounded = room_for_rows(rows, rows)
    if rows:
        bounded = Bounded(
            np.array([rows]), np.arange(rows + 1), np.arange(rows), np.tile((0.0, 0.0, 10.0), (rows, 1)),
            np.column_stack((np.full(rows, -1), np.arange(rows))), np.tile((0.0, 0.0, 0.0, 0.0, 0.0, 1.0), (rows, 1)),
            zeros(rows, BOUNDED_ROW), np.zeros((rows, 2), np.int64),
        )  # fmt: skip
        for i in range(rows):
            bounded.ROWS[i].speed, bounded.ROWS[i].low, bounded.ROWS[i].high = 2.0 * (-1.0) ** i, -0.05, 0.08
        weigh_rows(bounded)
    return JointedProblem(contacts, columns, bounded, m)


def drawn(seed: int, m: int = 6, k: int = 4, rows: int = 0) -> tuple[JointedProblem, Array]:
    """A random problem of m contacts among k bodies, and free velocities (k, 3)."""
    rng = np.random.default_rng(seed)
    pairs = [(int(a), int(b)) for a, b in (sorted(rng.choice(k, 2, replace=False)) for _ in range(m))]
    angles = rng.uniform(0.0, 2.0 * np.pi, m)
    places = rng.normal(size=(k, 2))
    points = np.array([places[a] + 0.3 * rng.normal(size=2) for a, _ in pairs])
    free = rng.normal(size=(k, 3))
    free[-1] = 0.0
    normals = np.column_stack((np.cos(angles), np.sin(angles)))
    return problem_of(pairs, points, normals, places, rng.choice((0.0, 0.3, 0.9)), rows), free


def off(problem: JointedProblem, L: Array, V: Array) -> float:
    """By how much the laws are broken: a velocity."""
    ROWS, _, D, m = problem
    worst = 0.0
    for i in range(m):
        (lam, beta), row, mu = L[i], ROWS[i], ROWS[i].friction
        un, ut = normal_rate(ROWS[i], V) - row.target, tangent_rate(ROWS[i], V)
        worst = max(worst, -un, -lam * row.a_nn, (abs(beta) - mu * lam) * row.a_nn)
        worst = max(worst, abs(un) if lam > 0.0 else 0.0)
        if abs(beta) < mu * lam * (1.0 - 1e-12):
            worst = max(worst, abs(ut))
        elif mu > 0.0 and lam > 0.0:
            worst = max(worst, np.sign(beta) * ut)
    for i in range(D.NUMBER[0]):
        x, row = L[m + i, 0], D.ROWS[i]
        u = row.speed + V[D.END[i, 1], 2]
        worst = max(worst, row.low - x, x - row.high)
        worst = max(worst, u if x >= row.high else -u if x <= row.low else abs(u))
    return float(worst)


@pytest.mark.parametrize("rows", [0, 3])
def test_homotopies_without_impulses_end_at_the_law(rows: int) -> None:
    """Anitescu and Potra's problems: no target is positive, nothing conveys."""
    states = set()
    for seed in range(30):
        problem, free = drawn(seed, rows=rows)
        L, V = np.zeros((problem.m + rows, 2)), free.copy()
        assert follow_homotopy(problem, L, V, free, True, False)
        assert off(problem, L, V) <= 1e-12
        again = free.copy()
        push(problem, L, 1.0, again)
        np.testing.assert_allclose(again, V, atol=1e-13)
        states |= {(lam > 0.0, abs(beta) >= problem.ROWS[0].friction * lam) for lam, beta in L[: problem.m].tolist()}
    assert len(states) == 3  # open, sticking, slipping


def test_homotopies_from_a_solution_nearby_end_at_the_law_or_nowhere() -> None:
    ended = 0
    for seed in range(30):
        problem, free = drawn(seed)
        L = np.zeros((problem.m, 2))
        assert follow_homotopy(problem, L, free.copy(), free, True, False)
        free[:-1] += 0.1 * np.random.default_rng(seed).normal(size=free[:-1].shape)
        V, before = np.empty_like(free), L.copy()
        velocities(problem, L, free, V)
        if follow_homotopy(problem, L, V, free, False, False):
            ended += 1
            assert off(problem, L, V) <= 1e-12
        else:
            np.testing.assert_array_equal(L, before)
    assert ended >= 27


def test_jammed_contacts_that_sweeps_carry_round() -> None:
    """A disk in a notch of faces at 60 degrees, mu = 2: it sticks at both, and may be wedged as hard as one likes. Its
    faces ask for velocities that differ by 1e-9, so that one of them has to let go: sweeps need a million rounds."""
    slope = np.array([[np.sin(1.0), np.cos(1.0)], [-np.sin(1.0), np.cos(1.0)]])
    problem = problem_of([(1, 0), (1, 0)], -0.5 * slope, slope, np.zeros((2, 2)), 2.0)
    problem.ROWS[0].target = -1e-9
    free = np.zeros((2, 3))
    free[0, 1] = -1.0
    L, V = np.zeros((2, 2)), free.copy()
    for _ in range(300):
        changed = sweep(problem, L, V)
    assert changed > 1e-11
    assert follow_homotopy(problem, L, V, free, False, False) or follow_homotopy(
        problem, np.zeros((2, 2)), free.copy(), free, True, False
    )
    assert off(problem, L, V) <= 1e-12


def test_bounded_rows_as_all_cases_tried() -> None:
    """Two motors on bodies that one contact joins: the only one of 9 states of the motors that is lawful."""
    for seed in range(10):
        problem, free = drawn(seed, m=1, k=3, rows=2)
        problem.ROWS[0].friction = 0.0
        L, V = np.zeros((3, 2)), free.copy()
        assert follow_homotopy(problem, L, V, free, True, False)
        found = []
        for states in itertools.product((-1, 0, 1), repeat=2):
            for held in (False, True):
                W, q, x = matrix(problem, free)
                fixed = {0: 0.0} if not held else {}
                bounds = {-1: -0.05, 1: 0.08}
                fixed |= {1 + i: bounds[s] for i, s in enumerate(states) if s != 0}
                free_ones = [i for i in range(3) if i not in fixed]
                for i, value in fixed.items():
                    x[i] = value
                if free_ones:
                    part = np.ix_(free_ones, free_ones)
                    x[free_ones] = np.linalg.solve(W[part], -(q + W @ x)[free_ones])
                trial = np.zeros((3, 2))
                trial[:, 0] = x
                speeds = free.copy()
                push(problem, trial, 1.0, speeds)
                if off(problem, trial, speeds) <= 1e-11:
                    found.append(trial)
        assert found
        assert min(np.abs(trial - L).max() for trial in found) <= 1e-10


def pinned(count: int, most: float) -> JointedProblem:
    """A chain of points of unit mass without contacts; neighbours are pinned by impulses of at most `most`."""
    rows = 2 * (count - 1)
    D = room_for_rows(rows, 2 * rows)
    D.NUMBER[0] = rows
    for i in range(rows):
        first, axis = divmod(i, 2)
        D.AT[i + 1], D.BODY[2 * i], D.BODY[2 * i + 1] = 2 * i + 2, first, first + 1
        D.N[2 * i, axis], D.N[2 * i + 1, axis] = -1.0, 1.0
        D.END[i], D.ROW[i, axis], D.ROW[i, 3 + axis] = (first, first + 1), -1.0, 1.0
        D.ROWS[i].part = SECOND_OF_DISC if axis else FIRST_OF_DISC
        D.ROWS[i].low, D.ROWS[i].high = -most, most
    weigh_rows(D)
    nothing = problem_of([], np.empty((0, 2)), np.empty((0, 2)), np.zeros((1, 2)), 0.0)
    return JointedProblem(nothing.ROWS, nothing.C, D, 0)


def test_chains_of_bounded_pivots_are_solved_as_a_whole() -> None:
    """Impulses inside their discs are linear rows: 30 points move as one after them. Sweeps from neighbour to neighbour
    need 900 rounds for each digit. If the largest impulse is more than is allowed, some slip, and none exceeds it."""
    rng, count = np.random.default_rng(0), 30
    free = np.column_stack((rng.normal(size=(count, 2)), np.zeros(count)))
    problem = pinned(count, 1e3)
    L, V = np.zeros((2 * count - 2, 2)), free.copy()
    assert solve_columns(problem, L, V, 1e-12, 3, 4, np.inf) <= 1e-12
    np.testing.assert_allclose(V, np.tile(free.mean(axis=0), (count, 1)), atol=1e-12)
    problem = pinned(count, 0.9 * float(np.hypot(L[::2, 0], L[1::2, 0]).max()))
    L, V = np.zeros((2 * count - 2, 2)), free.copy()
    assert solve_columns(problem, L, V, 1e-10, 3, 5000, np.inf) <= 1e-10
    sizes = np.hypot(L[::2, 0], L[1::2, 0]) / problem.B.ROWS[0].high
    assert 1.0 - 1e-12 <= sizes.max() <= 1.0 + 1e-12
    apart = np.linalg.norm(np.diff(V[:, :2], axis=0), axis=1)
    assert apart.max() > 0.01
    assert np.all(apart[sizes < 1.0 - 1e-12] <= 1e-8)


def matrix(problem: JointedProblem, free: Array) -> tuple[Array, Array, Array]:
    """Velocities per impulse (3, 3) of a normal and two motors, free ones (3,), and room for impulses (3,)."""

    def rates(V: Array) -> Array:
        contact = normal_rate(problem.ROWS[0], V) - problem.ROWS[0].target
        return np.array([contact, *(problem.B.ROWS[i].speed + V[i, 2] for i in range(2))])

    q, columns = rates(free), []
    for j in range(3):
        L, V = np.zeros((3, 2)), free.copy()
        L[j, 0] = 1.0
        push(problem, L, 1.0, V)
        columns.append(rates(V) - q)
    return np.column_stack(columns), q, np.zeros(3)


def test_paths_through_contacts_that_nothing_moves_end_nowhere() -> None:
    """A contact without mobility, whose surfaces close: its pivot is 0."""
    problem, free = drawn(0)
    problem.C.N[:], problem.C.T[:] = 0.0, 0.0
    L = np.zeros((problem.m, 2))
    with np.errstate(all="ignore"):
        assert not follow_homotopy(problem, L, free.copy(), free, True, False)
    assert not L.any()


def jammed_stack(mu: float, seed: int, boxes: int = 8) -> tuple[JointedProblem, Array, Array]:
    """Unit boxes in a stack, random impulses (m, 2) and the free velocities (k, 3) that these stop. The friction of
    the two points of a face is inside the cone, or acts against each other on its edges; the states of such faces may
    have a matrix without inverse."""
    rng = np.random.default_rng(seed)
    pairs = [(i - 1 if i > 0 else boxes, i) for i in range(boxes) for _ in range(2)]
    points = np.array([(x, float(i)) for i in range(boxes) for x in (-0.5, 0.5)])
    places = np.array([(0.0, i + 0.5) for i in range(boxes)] + [(0.0, 0.0)])
    problem = problem_of(pairs, points, np.tile((0.0, 1.0), (2 * boxes, 1)), places, mu)
    L = np.column_stack((rng.uniform(0.5, 1.0, 2 * boxes), np.zeros(2 * boxes)))
    for i in range(boxes):
        part = rng.choice((-1.0, 1.0)) * np.array((1.0, -1.0)) if rng.random() < 0.5 else rng.uniform(-0.9, 0.9, 2)
        L[2 * i : 2 * i + 2, 1] = mu * L[2 * i : 2 * i + 2, 0] * part
    free = np.zeros((boxes + 1, 3))
    push(problem, L, -1.0, free)
    return problem, L, free


@pytest.mark.parametrize("mu", [0.25, 0.3, 1 / 3, 0.5, 1.0])
def test_stacks_whose_faces_jam_start_at_their_impulses(mu: float) -> None:
    """Impulses that stop all boxes are the solution: the homotopy ends where it begins, whatever the order of its
    pivots."""
    for seed in range(20):
        problem, L, free = jammed_stack(mu, seed)
        V = np.zeros_like(free)
        assert follow_homotopy(problem, L, V, free, False, False)
        assert np.abs(V).max() <= 1e-4  # where the matrix has no inverse; sweeps follow
        assert np.abs(L).max() <= 1.0


def test_friction_of_a_face_against_itself_does_not_delay_a_stack() -> None:
    """From impulses that miss by little, one homotopy stops all boxes: it takes the work of its start alone."""
    for seed in range(20):
        problem, L, free = jammed_stack(0.5, seed)
        free[:-1] += 1e-6 * np.random.default_rng(seed).normal(size=free[:-1].shape)
        V = np.empty_like(free)
        velocities(problem, L, free, V)
        assert solve_columns(problem, L, V, 1e-12, 0, 1, np.inf) <= 1e-12
        assert np.abs(V).max() <= 1e-12
        start = HOMOTOPY_WORK + MATRIX_WORK * len(L) * 2 * len(L) * 2 + len(L) * work_of_change(2 * len(L))
        assert problem.C.WORK[0] <= 1.01 * start
