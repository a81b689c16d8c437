"""One interval of one island: v+ = v + h a + M^-1 (G^T lam + T^T beta), each body on the parabola between v and v+."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray
from ..compiled import Table, kernel, nonallocating
from ..compiled.records import Rows, empty, zeros
from ..model.contacts import ROW, SOLVED, Problem, Row
from ..model.islands import Island, IslandContacts, contacts_of, island_of
from ..model.parameters.impulses import WEDGED
from ..model.parameters.intervals import (
    DIRECT,
    DIRECT_MOVING,
    INTERVAL_RESIDUAL,
    INTERVAL_RESIDUAL_MOVING,
    INTERVAL_RESIDUAL_SPEED,
    INTERVAL_UNMET,
    LARGE_ISLAND,
    REACH_ROUND_OFF,
    RESIDUAL_OF_SPEED,
    TRAVEL_MARGIN,
)
from ..model.scene import Scene, scene_of
from ..rows.blocks import clear_report
from ..rows.build import conserves, rates
from ..rows.energy import lock, losses
from ..rows.gentle import excessive, unwedge
from ..rows.inplace import copy
from ..rows.laws import solved_exactly
from ..rows.sweeps import velocities
from .correction import stop_at_walls
from .forces import find, remember_loads, table_has_room
from .gathering import gather_contacts
from .relaxation import relax
from .statics import find_static_forces
from .targets import target


@nonallocating
def recall(A: Scene, ROWS: Rows[Row], m: int, h: float, whole: bool, L: FloatArray, EXPECTED: FloatArray) -> None:
    """Set the initial impulses L (m, 2), and those of loads EXPECTED (m,), from remembered forces of this step or the
    last.

    whole: L is force times h, best where sweeps over many contacts end before they converge. Else the force acts no
    longer than in the interval of which it is known: a force that stopped bodies in a short interval is large, and over
    a long h Newton's method of jointed bodies would start far from its solution.
    """
    for i in range(m):
        L[i, 0] = L[i, 1] = 0.0
        EXPECTED[i] = 0.0
        row = find(A.KEYS, ROWS[i].key)
        if row >= 0 and A.FORCES[row].stamp >= A.PAR.stamp - 1.0:
            force = A.FORCES[row]
            span = h if whole else min(h, force.length)
            L[i, 0], L[i, 1] = span * force.normal, span * force.tangential
            EXPECTED[i] = h * force.load


@nonallocating
def speeds(isle: Island, n: int, h: float, REACH: FloatArray) -> tuple[float, float, float]:
    """Root mean square over the n bodies of the speed of their fastest points, the largest such speed, and the largest
    acceleration |a| of a point. Sets REACH (k,), a bound of how far points of bodies move in h.

    Speeds in a free island are relative to its centre of mass. Where nothing accelerates, those of bodies that impulses
    do not move count, too: bodies at rest that something moves into will be as fast.
    """
    V, ACC, EXTENT, IM, x, y = isle.V, isle.ACC, isle.EXTENT, isle.IM, 0.0, 0.0
    if len(IM) == n:
        mass = 0.0
        for i in range(n):
            mass += 1.0 / IM[i]
            x += V[i, 0] / IM[i]
            y += V[i, 1] / IM[i]
        x /= mass
        y /= mass
    square, most, pull, wall_speed = 0.0, 0.0, 0.0, 0.0
    for i in range(len(IM)):
        pull = max(pull, math.sqrt(ACC[i, 0] ** 2 + ACC[i, 1] ** 2) + abs(ACC[i, 2]) * EXTENT[i])
    for i in range(len(IM)):
        speed = math.sqrt((V[i, 0] - x) ** 2 + (V[i, 1] - y) ** 2) + abs(V[i, 2]) * EXTENT[i]
        REACH[i] = TRAVEL_MARGIN * speed * h
        if i < n:
            REACH[i] += TRAVEL_MARGIN * pull * h * h + REACH_ROUND_OFF * EXTENT[i]
            square += speed * speed
            most = max(most, speed)
        else:
            wall_speed = max(wall_speed, speed)
    if pull == 0.0:
        return max(math.sqrt(square / n), wall_speed), max(most, wall_speed), pull
    return math.sqrt(square / n), most, pull


@kernel
def make_contacts(p: int, k: int) -> IslandContacts:
    """Empty contacts for p pairs of shapes of k bodies."""
    room, OUT = 2 * p + 1, zeros(1, SOLVED)
    clear_report(OUT[0])
    return IslandContacts(empty(room, ROW), np.zeros((room, 2)), np.zeros((k, 3)), np.zeros((k, 6)), OUT)


class Begun(NamedTuple):
    """The m contacts of an interval, -1 if they or the memory of forces need more memory; (m,) the impulses of loads
    that forces of the last step let expect; the three `speeds` of the island."""

    m: int
    EXPECTED: FloatArray
    slow: float
    fast: float
    pull: float


@kernel
def begin_contacts(A: Scene, isle: Island, contacts: IslandContacts, n: int, h: float, least_reach: float) -> Begun:
    """Find the contacts of an island over an interval h, with initial impulses. least_reach: see `step_island`."""
    k = len(isle.IM)
    clear_report(contacts.OUT[0])
    REACH = np.empty(k)
    slow, fast, pull = speeds(isle, n, h, REACH)
    REACH = np.maximum(REACH, least_reach)
    m = gather_contacts(A, isle, contacts, REACH, h, k == n)
    if not table_has_room(A, m):
        return Begun(-1, np.empty(0), slow, fast, pull)
    copy(contacts.VN, isle.V + h * isle.ACC)
    contacts.JUMP[:] = 0.0
    EXPECTED = np.empty(m)
    recall(A, contacts.ROWS, m, h, True, contacts.L, EXPECTED)
    return Begun(m, EXPECTED, slow, fast, pull)


@kernel
def find_rest(
    A: Scene, isle: Island, contacts: IslandContacts, n: int, h: float, begun: Begun, rest_speed: float, hold: bool
) -> bool:  # fmt: skip
    """Test an island with contacts for static forces (`.statics`). If they exist, V is set to 0, and the caller has to
    account its energy; if they also `hold` the bodies, they are the impulses of the island, and are remembered."""
    m, V, OUT = begun.m, isle.V, contacts.OUT
    problem = Problem(contacts.ROWS, isle.IM, isle.II, isle.POSE, n, m)
    rates(contacts.ROWS, V, m)
    target(contacts.ROWS, m, isle.ACC, begun.EXPECTED, begun.pull, h)
    found, OUT[0].direct = find_static_forces(
        problem, contacts.L[:m], V, V + h * isle.ACC, isle.LEVER, contacts.VN, begun.pull * h, rest_speed, hold
    )
    if found:
        OUT[0].at_rest = 1
        if hold:
            remember_loads(A, contacts.ROWS, contacts.L, m, h)
    return found


@kernel
def step_island(
    SCENE: Table, ISLE: Table, CONTACTS: Table, n: int, h: float, most: int, least_reach: float, owed: float,
    rest_speed: float,
) -> int:  # fmt: skip
    """Solve an island over an interval of length h.

    Args:
        SCENE: its shapes, vertices, rules, scratch of the geometry, memory of forces.  ISLE: its bodies and pairs.
        CONTACTS: out, its rows, impulses, velocities, report.
        n: number of bodies that impulses move; the others keep their velocities.
        most: largest number of sweeps of a large moving island, or while direct solves are suspended.
        least_reach: way that points of bodies may move in h at least; 0: as their velocities let expect.
        owed: energy >= 0 that the island has to lose at least.
        rest_speed: speed relative to |a| h below which the island is tested for static forces (`find_rest`); 0 for no
            test.

    Returns:
        The number m of contacts; -1, with no result, if the contacts or the memory of forces need more memory.
    """
    A, isle, contacts = scene_of(SCENE), island_of(ISLE), contacts_of(CONTACTS)
    ROWS, VN, OUT = contacts.ROWS, contacts.VN, contacts.OUT
    begun = begin_contacts(A, isle, contacts, n, h, least_reach)
    m, slow, fast, pull = begun.m, begun.slow, begun.fast, begun.pull
    if m > 0:
        if rest_speed > 0.0 and find_rest(A, isle, contacts, n, h, begun, rest_speed, True):
            return m
        rates(ROWS, isle.V, m)
        target(ROWS, m, isle.ACC, begun.EXPECTED, pull, h)
        problem, L, FREE = Problem(ROWS, isle.IM, isle.II, isle.POSE, n, m), contacts.L[:m], isle.V + h * isle.ACC
        velocities(problem, L, FREE, VN)
        scale = pull * h if pull > 0.0 else RESIDUAL_OF_SPEED * fast
        elastic = conserves(ROWS, m)
        # A truncated solve dissipates energy in large elastic islands: these are solved to the fine tolerance.
        few = n < LARGE_ISLAND
        rounds = DIRECT if elastic or slow < pull * h else (DIRECT_MOVING if few else 0)
        coarse = 0.0 if elastic or few else INTERVAL_RESIDUAL_MOVING * scale + INTERVAL_RESIDUAL_SPEED * slow
        worst = relax(
            problem, L, VN, FREE, rounds, INTERVAL_RESIDUAL * scale, coarse, A.RESTING[isle.WHO[0]], most, OUT[0]
        )
        # Few contacts are solved to INTERVAL_UNMET; more are left as far as their budget of sweeps solves them.
        top_speed, exactly = fast + pull * h, solved_exactly(n, m)
        if not exactly:
            stop_at_walls(A, problem, n, np.zeros(m, np.int64), L, VN)
        velocities(problem, L, FREE, VN)  # without the round-off of many sweeps
        wedged = exactly and (worst > WEDGED * scale or excessive(L, m, isle.IM, n, top_speed))
        OUT[0].lock = lock(problem, L, VN, FREE, owed, elastic)
        if wedged or (exactly and OUT[0].lock < 1.0 - WEDGED):
            worst = unwedge(problem, L, VN, FREE, INTERVAL_RESIDUAL * scale, top_speed, OUT[0])
            OUT[0].lock = lock(problem, L, VN, FREE, owed, elastic)
        OUT[0].residual, OUT[0].tolerance = worst, INTERVAL_UNMET * scale if exactly else np.inf
        OUT[0].restitution, OUT[0].friction = losses(problem, L, VN)
        remember_loads(A, ROWS, L, m, h)
    return m
