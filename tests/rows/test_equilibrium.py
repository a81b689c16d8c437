"""Forces that balance: found where linear programming finds some, none where it finds none, and next to the guess."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest
from scipy.optimize import linprog

from eeca_pymunk.compiled.records import rows
from eeca_pymunk.model.contacts import Problem, Row
from eeca_pymunk.rows.build import place_row
from eeca_pymunk.rows.equilibrium import equilibrium
from eeca_pymunk.rows.sweeps import velocities

Floats = npt.NDArray[np.float64]
UNITS = (1e-3, 1.0, 1e3)
G = 9.81


class Pile:
    """Bodies, the ground last, with contacts (a, b, n, point) of friction mu; velocities `start` are to be taken."""

    def __init__(
        self, pose: Floats, im: Floats, ii: Floats, contacts: list[tuple[int, int, float, float, float, float]],
        mu: float, start: Floats,
    ) -> None:  # fmt: skip
        self.pose, self.im, self.ii, self.start, self.m = pose, im, ii, start, len(contacts)
        self.rows, self.L = rows(Row, self.m), np.zeros((self.m, 2))
        for i, (a, b, nx, ny, x, y) in enumerate(contacts):
            row = self.rows[i]
            row.a, row.b, row.nx, row.ny, row.friction = a, b, nx, ny, mu
            place_row(row, x, y, pose, im, ii)

    def solve(self, most: int = 20, tolerance: float = 1e-9) -> bool:
        speed = float(np.abs(self.start).max())
        problem = Problem(self.rows, self.im, self.ii, self.pose, len(self.im) - 1, self.m)
        self.found, self.factors = equilibrium(
            problem, self.L, self.start, np.ones(len(self.im)), tolerance * speed, most
        )
        return self.found

    def left(self, L: Floats, start: Floats | None = None) -> Floats:
        """Velocities that impulses L leave of the start."""
        V = np.empty_like(self.start)
        free = self.start if start is None else start
        problem = Problem(self.rows, self.im, self.ii, self.pose, len(self.im) - 1, self.m)
        velocities(problem, np.ascontiguousarray(L), free, V)
        return V

    def edges(self) -> Floats:
        """(3 n, 2 m) velocities from impulses 1 along each edge of each cone."""
        columns = []
        for i in range(self.m):
            for slope in (self.rows["friction"][i], -self.rows["friction"][i]):
                L = np.zeros((self.m, 2))
                L[i] = 1.0, slope
                columns.append(self.left(L, np.zeros_like(self.start))[:-1].ravel())
        return np.array(columns).T

    def balances(self) -> None:
        """What was found takes all motion, inside the cones."""
        speed = np.abs(self.start).max()
        assert np.abs(self.left(self.L)).max() <= 1e-9 * speed
        assert (self.L[:, 0] >= 0).all()
        assert (np.abs(self.L[:, 1]) <= self.rows["friction"] * self.L[:, 0] * (1 + 1e-12)).all()


def random_pile(seed: int, friction: float) -> Pile:
    """Bodies in a row of random contacts with each other and the ground, under random pulls."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 6))
    pose, start = np.zeros((n + 1, 3)), np.zeros((n + 1, 3))
    pose[:n, 0], pose[:n, 1] = 2.0 * np.arange(n), rng.uniform(-0.2, 0.2, n)
    start[:n, :2] = np.array([0.0, -1.0]) + 0.1 * rng.normal(size=(n, 2))
    contacts = []
    for i in range(n):
        for x in (-0.8, 0.8):
            turn = 0.2 * rng.normal()
            contacts.append((i, n, math.sin(turn), -math.cos(turn), pose[i, 0] + x, pose[i, 1] - 1.0))
        if i + 1 < n:
            turn = 0.2 * rng.normal()
            contacts.append((i, i + 1, math.cos(turn), math.sin(turn), pose[i, 0] + 1.0, rng.uniform(-1, 1)))
    kept = [c for c in contacts if rng.random() < 0.85] or contacts[:1]
    return Pile(
        pose, np.append(rng.uniform(0.5, 2, n), 0.0), np.append(rng.uniform(0.5, 2, n), 0.0), kept, friction, start
    )


@pytest.mark.parametrize("friction", [0.0, 0.3, 1.0])
def test_there_are_forces_iff_linear_programming_finds_some(friction: float) -> None:
    stood = 0
    for seed in range(60):
        pile = random_pile(seed, friction)
        edges = pile.edges()
        answer = linprog(np.zeros(edges.shape[1]), A_eq=edges, b_eq=-pile.start[:-1].ravel(), method="highs")
        assert pile.solve() == (answer.status == 0), seed
        if pile.found:
            pile.balances()
            stood += 1
    assert stood > 5 if friction else stood < 55


def wall(seed: int, courses: int, bricks: int) -> Pile:
    """Bricks on two others each, not quite flat: a tenth of their contacts are missing; all under random pulls."""
    rng = np.random.default_rng(seed)
    n = courses * bricks
    pose, start = np.zeros((n + 1, 3)), np.zeros((n + 1, 3))
    start[:n] = np.array([0.0, -1.0, 0.0]) + 0.1 * rng.normal(size=(n, 3))
    contacts = []
    for i in range(n):
        course, c = divmod(i, bricks)
        x, odd = 2.0 * c + course % 2, course % 2
        pose[i, :2] = x, course + 0.5
        if course == 0:
            contacts += [(i, n, 0.0, -1.0, x + side, 0.0) for side in (-0.9, 0.9)]
        else:
            for below in (c - 1 + odd, c + odd):
                turn, other = 0.15 * rng.normal(), 2.0 * below + 1 - odd
                for end in (max(x, other) - 1.0, min(x, other) + 1.0):
                    if 0 <= below < bricks and rng.random() < 0.9:
                        k = (course - 1) * bricks + below
                        contacts.append((i, k, math.sin(turn), -math.cos(turn), end, float(course)))
        if c + 1 < bricks and rng.random() < 0.9:
            turn = 0.1 * rng.normal()
            contacts.append((i, i + 1, math.cos(turn), math.sin(turn), x + 1.0, course + rng.random()))
    return Pile(pose, np.append(np.ones(n), 0.0), np.append(np.full(n, 2.4), 0.0), contacts, 0.3, start)


@pytest.mark.parametrize("seed", [6, 18, 28, 78])
def test_what_takes_long_to_balance_is_not_taken_for_what_nothing_holds(seed: int) -> None:
    pile = wall(seed, 6, 20)
    edges = pile.edges()
    answer = linprog(np.zeros(edges.shape[1]), A_eq=edges, b_eq=-pile.start[:-1].ravel(), method="highs")
    assert pile.solve() == (answer.status == 0)
    if pile.found:
        pile.balances()


def on_slope(angle: float, mu: float, unit: float) -> Pile:
    """A block twice as wide as it is high, on a slope; its pull in the frame of the slope."""
    pull = G * unit * np.array([math.sin(angle), -math.cos(angle), 0.0])
    contacts = [(0, 1, 0.0, -1.0, x * unit, -0.5 * unit) for x in (-1.0, 1.0)]
    pose = np.zeros((2, 3))
    return Pile(
        pose, np.array([1.0, 0.0]), np.array([12 / (5 * unit**2), 0.0]), contacts, mu, np.array([pull, np.zeros(3)])
    )


@pytest.mark.parametrize("unit", UNITS)
def test_a_block_stands_on_a_slope_up_to_its_friction_and_to_its_corner(unit: float) -> None:
    for off, stands in ((1 - 1e-6, True), (1 + 1e-6, False)):
        pile = on_slope(math.atan(0.5 * off), 0.5, unit)
        assert pile.solve() == stands
        if stands:
            pile.balances()
        # It topples where its centre is beyond the corner: tan = width / height = 2.
        assert on_slope(math.atan(2.0 * off), 5.0, unit).solve() == stands


@pytest.mark.parametrize("unit", UNITS)
def test_loads_that_many_can_bear_stay_next_to_the_guess(unit: float) -> None:
    """A beam on five supports: the answer of the least change in the measure A_nn, by Lagrange's equations."""
    at = unit * np.array([-2.0, -1.2, 0.1, 0.9, 2.0])
    contacts = [(0, 1, 0.0, -1.0, float(x), -0.1 * unit) for x in at]
    start = np.array([[0.0, -G * unit, 0.0], [0.0, 0.0, 0.0]])
    pile = Pile(np.zeros((2, 3)), np.array([1.0, 0.0]), np.array([0.7 / unit**2, 0.0]), contacts, 0.0, start)
    guess = G * unit * np.array([0.3, 0.1, 0.2, 0.25, 0.1])
    pile.L[:, 0] = guess
    assert pile.solve()
    pile.balances()
    J = np.array([np.ones(5), at])
    A = 1.0 + 0.7 / unit**2 * at**2
    B = J / A
    wanted = guess + B.T @ np.linalg.solve(B @ J.T, np.array([G * unit, 0.0]) - J @ guess)
    assert (wanted > 0).all()
    assert pile.L[:, 0] == pytest.approx(wanted, rel=1e-5)


def test_what_nothing_holds_or_is_left_out_has_none() -> None:
    pile = on_slope(0.1, 0.5, 1.0)
    pile.rows["target"][1] = -1.0
    assert not pile.solve()
    pile.rows["target"][0] = -1.0
    assert not pile.solve()
    pile.start[:] = 0.0
    assert pile.solve()


def test_self_stress_between_walls_stays_what_it_was() -> None:
    """Walls that press a block from both sides may do so with any force: it is that of the guess."""
    contacts = [(0, 1, 1.0, 0.0, 0.5, 0.0), (0, 1, -1.0, 0.0, -0.5, 0.0), (0, 1, 0.0, -1.0, 0.0, -0.5)]
    start = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 0.0]])
    pile = Pile(np.zeros((2, 3)), np.array([1.0, 0.0]), np.array([6.0, 0.0]), contacts, 0.0, start)
    pile.L[:, 0] = 3.0, 3.0, 0.9
    assert pile.solve()
    assert pile.L[:, 0] == pytest.approx([3.0, 3.0, 1.0], rel=1e-6)


@pytest.mark.parametrize("friction", [0.0, 0.3, 1.0])
def test_where_nothing_holds_the_search_ends_before_its_budget(friction: float) -> None:
    """With a proof: motions against which no contact acts, though forces do, so that impulses x >= 0 along the edges of
    the cones that balance the forces would have a sum beyond any of a pile."""
    ended = 0
    for pile in [random_pile(seed, friction) for seed in range(60)] + [wall(seed, 4, 8) for seed in range(4)]:
        n = len(pile.im) - 1
        mass = 1.0 / np.column_stack((pile.im, pile.im, pile.ii))[:n]
        pull = pile.start[:-1] * mass
        if pile.solve():
            continue
        motion = pile.start[:-1]
        work, acting = -(pull * motion).sum(), (pile.edges() * (mass * motion).reshape(-1, 1)).sum(axis=0)
        assert pile.factors <= 12
        assert work > 10.0 * n * np.abs(pull).sum() * acting.max(initial=0.0)
        ended += 1
    assert ended > 3
