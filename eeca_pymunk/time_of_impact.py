"""TimeOfImpact: the closure that puts every impulse at its computed time of impact (design sections 3, 4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arrays import Motion, Start
from .bodies import Bodies, BoolArray, FloatArray, IntArray
from .complementarity import components
from .contacts import ROUND_OFF, Pairs, distance_from_axes, length, touching
from .detection import MarginTwin
from .forecast import next_impact
from .impacts import Impacts
from .paths import Paths
from .stepper import StepReport

_TIE = 1e-6  # part of dt within which two impacts of one body may be the same instant up to round-off of places
_BOUNCES = 16  # of one contact within a step after which it stops if its elasticity is below 1


@dataclass(frozen=True)
class TimeOfImpact:
    """psi2 = 1 - 2 tau / dt with tau the time of impact, and the normal there: exact for disks and flat walls.

    The step follows the paths of the bodies from impact to impact, in rounds: every round takes the contacts that are
    the earliest of both their bodies, all at once, kinks the paths there, and looks anew at the pairs of these bodies.
    Impacts of one body at one instant, up to round-off, and contacts that touch then are solved together. Exact up to
    round-off for elastic and inelastic impacts of disks with disks and walls under constant forces, at any dt; second
    order where contacts rest on curved shapes.

    Args:
        max_rounds: of a step. What is left after them stays for the next step, and the report says not converged.
    """

    max_rounds: int = 100_000

    def advance(self, bodies: Bodies, start: Start, twin: MarginTwin) -> Motion:
        displacement = start.free_displacement
        # The path of a thrown body leaves its chord.
        slack = (0.125 * start.dt**2) * length(start.acceleration) + ROUND_OFF * distance_from_axes(start.position)
        pairs = twin.candidates(start.position, displacement, slack)
        if len(pairs) == 0:
            velocity = start.velocity + start.dt * start.acceleration
            return Motion(velocity, displacement, StepReport.without_contacts(start.time, bodies.items))
        return Rounds(bodies, start, twin, pairs, slack).run(self.max_rounds)


class Rounds:
    """The impacts of one step, in rounds. Contacts are numbered by their place in the list of pairs."""

    def __init__(self, bodies: Bodies, start: Start, twin: MarginTwin, pairs: Pairs, slack: FloatArray) -> None:
        self.start, self.twin, self.slack = start, twin, slack
        self.moves: BoolArray = bodies.dynamic
        self.paths = Paths(start, np.flatnonzero(bodies.dynamic))
        self.impacts = Impacts(bodies, start, self.paths)
        self.may_stop = self.paths.pulled or bool((twin.shapes.elasticity < 1.0).any())
        self.rows = np.arange(len(bodies))
        none = np.zeros(0, np.intp)
        near = self._list(pairs, none, none)
        if len(near):
            self._begin(near)

    def _list(self, pairs: Pairs, touch: IntArray, rest: IntArray) -> IntArray:
        """Take a list of pairs; `touch` and `rest` are the keys of those that touch and that rest on each other.

        Returns the contacts that are closed.
        """
        self.pairs = pairs
        self.time, gap = next_impact(pairs, self.paths, np.arange(len(pairs)), self.start.dt)
        self.bounces: IntArray = np.zeros(len(pairs), np.intp)
        self.touch: IntArray = np.searchsorted(pairs.key, touch)
        self.rest: IntArray = np.searchsorted(pairs.key, rest)
        self.time[self.touch] = np.inf
        self._join()
        position = self.start.position
        coarse = ROUND_OFF * (np.abs(position).max() + pairs.extent.max(initial=0.0))
        near = np.flatnonzero(gap <= coarse)
        return near[gap[near] <= touching(pairs.take(near), position)] if len(near) else near

    def _begin(self, near: IntArray) -> None:
        """The contacts that touch at the start form blocks with what hits them there, and may rest."""
        self.touch = near
        self._join()
        self._strike(near, np.zeros(len(near)))
        self._look_again(near)

    def _join(self) -> None:
        """Bodies that touch wait for each other: what hits one of them hits all."""
        self.label: IntArray = self.rows
        if len(self.touch):
            self.label = components(self.pairs.row_a[self.touch], self.pairs.row_b[self.touch], self.moves)

    def run(self, max_rounds: int) -> Motion:
        """Rounds until nothing is due within the step; the motion and its report."""
        start, paths = self.start, self.paths
        rounds = 0
        while len(due := np.flatnonzero(self.time < start.dt)) and rounds < max_rounds:
            rounds += 1
            self._look_again(self._take(due))
        t = np.full(len(self.rows), start.dt)
        displacement = paths.position(self.rows, t) - start.position
        report = self.impacts.report(self.pairs, rounds, converged=len(due) == 0)
        return Motion(paths.rate(self.rows, t), displacement, report)

    def _take(self, due: IntArray) -> IntArray:
        """One round: apply the impulses of the earliest contacts among `due`; the contacts it took."""
        pairs, t = self.pairs, self.time[due]
        a, b = self._labels(due)
        earliest = np.full(len(self.rows), np.inf)
        np.minimum.at(earliest, a, t)
        np.minimum.at(earliest, b, t)
        earliest[~self.moves] = np.inf  # a wall waits for nobody
        wait = np.maximum(t - earliest[a], t - earliest[b])
        nearly = due[(wait > 0.0) & (wait <= _TIE * self.start.dt)]
        lone, block = self._split(due[wait <= 0.0], self._ties(nearly, earliest))
        if len(lone):
            chosen, time = pairs.take(lone), self.time[lone]
            at, approach = self.impacts.meet(chosen, time)
            if self.may_stop:
                stops = self.impacts.stays(chosen, chosen.elasticity * approach) | self._spent(lone)
                if stops.any():
                    goes = np.flatnonzero(~stops)
                    block, lone, time = np.union1d(block, lone[stops]), lone[goes], time[goes]
                    chosen, at, approach = chosen.take(goes), at.take(goes), approach[goes]
                self.bounces[lone] += 1
            self.impacts.bounce(chosen, at, approach, time)
        if len(block) == 0:
            return lone
        self._strike(block, np.where(np.isin(block, due), self.time[block], np.inf))
        return np.concatenate((lone, block))

    def _ties(self, nearly: IntArray, earliest: FloatArray) -> IntArray:
        """Those of the contacts that are closed already, up to round-off, at the earliest instant of their bodies."""
        if len(nearly) == 0:
            return nearly
        chosen = self.pairs.take(nearly)
        a, b = self._labels(nearly)
        gap = self.impacts.meet(chosen, np.minimum(earliest[a], earliest[b]))[0].gap
        return nearly[gap <= touching(chosen, self.start.position)]

    def _split(self, first: IntArray, ties: IntArray) -> tuple[IntArray, IntArray]:
        """Of the earliest contacts those that act alone, and the blocks: what shares a body, ties, and what touches."""
        a, b = self._labels(first)
        # A contact that finds another's number on a body of its own shares that body.
        number, owner = np.arange(len(first)), np.empty(len(self.rows), np.intp)
        owner[a] = number
        owner[b] = number
        clash = (owner[a] != number) | ((owner[b] != number) & self.moves[b])
        if len(ties) == 0 and len(self.touch) == 0 and not clash.any():
            return first, ties
        joint, hot = np.zeros(len(self.rows), bool), np.zeros(len(self.rows), bool)
        for of_a, of_b in ((a[clash], b[clash]), self._labels(ties), self._labels(self.touch)):
            joint[of_a] = joint[of_b] = True
        joint[~self.moves] = False
        together = joint[a] | joint[b]
        hot[a[together]] = hot[b[together]] = True
        tie_a, tie_b = self._labels(ties)
        hot[~self.moves] = False
        joining = hot[tie_a] | hot[tie_b]
        hot[tie_a[joining]] = hot[tie_b[joining]] = True
        touch = self.touch[hot[self._labels(self.touch)[0]]]
        return first[~together], np.unique(np.concatenate((first[together], ties[joining], touch)))

    def _labels(self, contacts: IntArray) -> tuple[IntArray, IntArray]:
        return self.label[self.pairs.row_a[contacts]], self.label[self.pairs.row_b[contacts]]

    def _strike(self, block: IntArray, seed: FloatArray) -> None:
        """Solve blocks (contacts, increasing) hit at the instants `seed`, and remember what touches and rests on."""
        resting = np.isin(block, self.rest, assume_unique=True)
        on, rest = self.impacts.strike(self.pairs.take(block), seed, self._spent(block), resting)
        self.touch = np.union1d(np.setdiff1d(self.touch, block), block[on])
        self.rest = np.union1d(np.setdiff1d(self.rest, block), block[rest])
        self.bounces[block] += 1
        self._join()

    def _spent(self, contacts: IntArray) -> BoolArray:
        """Whether a contact has bounced so often that it has to stop, so that no dissipating bounce goes on forever."""
        spent: BoolArray = (self.bounces[contacts] >= _BOUNCES) & (self.pairs.elasticity[contacts] < 1.0)
        return spent

    def _look_again(self, taken: IntArray) -> None:
        """Forecast anew what the bodies of the contacts just taken meet; these contacts do not act again at once."""
        pairs, paths, dt = self.pairs, self.paths, self.start.dt
        both = np.concatenate((pairs.row_a[taken], pairs.row_b[taken]))
        rows = both[self.moves[both]]
        moved = paths.position(rows, np.full(len(rows), dt)) - self.start.position[rows]
        if not self.twin.covers(rows, moved, self.slack[rows]):
            # An impulse sent a body farther than its margin: pairs that were not near may meet now.
            touch, rest = pairs.key[self.touch], pairs.key[self.rest]
            self._list(self.twin.widen(self.start.position), touch, rest)
            return
        changed = np.zeros(len(self.rows), bool)
        changed[rows] = True
        again = np.flatnonzero(changed[pairs.row_a] | changed[pairs.row_b])
        self.time[again] = next_impact(pairs, paths, again, dt)[0]
        self.time[self.touch] = np.inf
        at_once = self.time[taken] <= np.maximum(paths.since[pairs.row_a[taken]], paths.since[pairs.row_b[taken]])
        self.time[taken[at_once]] = np.inf
