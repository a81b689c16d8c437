"""Records of a run of many steps: what is asked for, how far it is, and what is kept of it."""

from __future__ import annotations

from typing import NamedTuple

from ..arrays import FloatArray, IntArray
from ..compiled import Opener
from ..compiled.records import Record, Rows
from .contacts import Impulse


class Run(Record):
    """Settings, progress and sums of a run."""

    dt: float  # length of each step
    gravity_x: float
    gravity_y: float
    left_over: float  # what the damping of half a step leaves of velocities
    time: float  # at the end of the steps that were taken
    lock: float  # scale of an energy lock that was farthest from 1
    until: int  # steps after which the loop returns
    done: int  # steps that were taken
    stage: int  # of the step at which the loop is: BETWEEN, WITHIN or AFTER
    bits: int  # of the step that goes on WITHIN or AFTER
    all_bits: int  # of any step so far
    every: int  # a frame is kept after so many steps; 0 for none
    frame: int  # row of FRAMES and SUMS that comes next
    impacts: int  # of all steps
    kept: int  # rows of EVENTS in use
    iterations: int  # solves of all steps
    unmet: int  # steps that left something undone
    rollout: int  # number of the rollout, and of the first one that is not to be made
    rollouts: int


BETWEEN, WITHIN, AFTER = 0, 1, 2


class RunArrays(NamedTuple):
    """What is kept of a run of b bodies, and where rollouts begin.

    KEPT (b,): rows of the bodies in STATES. FRAMES (T b, 6): poses and velocities of T frames. SUMS (T, 6): ledgers of
    all steps so far, summed, in the order of `energy.ledger.Ledger`. EVENTS: impacts, `when` from the start of the run;
    none are kept if there is no row. TOTAL (6,): the sum so far. INITIAL (K b, 6): poses and velocities at the start of
    each of K rollouts. PUSH (K T b, 3): forces and torques in each stretch of `every` steps, or none. COUNTS (K, 2):
    steps of each rollout that left something undone, rows of EVENTS in use at its end. OWN, FRESH: the memory of the
    scene that steps change, and what is in it where nothing has been stepped.
    """

    RUN: Run
    KEPT: IntArray
    FRAMES: FloatArray
    SUMS: FloatArray
    EVENTS: Rows[Impulse]
    TOTAL: FloatArray
    INITIAL: FloatArray
    PUSH: FloatArray
    COUNTS: IntArray
    OWN: IntArray
    FRESH: IntArray


run_arrays_of = Opener(RunArrays)
