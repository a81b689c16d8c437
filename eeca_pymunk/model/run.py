"""Records of a run of many steps: its settings, its progress, its results."""

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
    half_damping: float  # factor by which the damping of half a step multiplies velocities
    time: float  # at the end of the last step taken
    lock: float  # scale of the energy lock that was farthest from 1
    until: int  # number of steps after which the loop returns
    done: int  # number of steps taken
    stage: int  # BETWEEN, WITHIN or AFTER
    bits: int  # status bits of all steps so far
    every: int  # a frame is stored after so many steps; 0 for none
    frame: int  # row of FRAMES and SUMS that is written next
    impacts: int  # of all steps
    kept: int  # rows of EVENTS in use
    iterations: int  # solves of all steps
    unmet: int  # steps that did not meet a budget or tolerance
    rollout: int  # number of the present rollout
    rollouts: int  # number of the first rollout that is not to be computed


# `Run.stage`: between two steps; within a step that needs more memory; after one whose results are not stored yet.
BETWEEN, WITHIN, AFTER = 0, 1, 2


class RunArrays(NamedTuple):
    """The results of a run of b bodies, and the starts of rollouts.

    KEPT (b,): rows of the bodies in STATES. FRAMES (T b, 6): poses and velocities of T frames. SUMS (T, 6): ledgers,
    summed over all steps so far, in the order of `energy.ledger.Ledger`. EVENTS: impacts, `when` from the start of the
    run; without rows none are stored. TOTAL (6,): the present sum. INITIAL (K b, 6): poses and velocities at the start
    of each of K rollouts. PUSH (K T b, 3): forces and torques for each group of `every` steps, or no rows. COUNTS
    (K, 2): for each rollout the steps that did not meet a budget or tolerance, and the rows of EVENTS in use at its
    end. OWN, FRESH: the memory of the scene that steps change, and its content before any step.
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
