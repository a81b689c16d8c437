"""TimeOfImpact: the closure that puts every impulse at its computed time of impact (design sections 3, 4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arrays import Motion, Start
from .blocks import Blocks, Resting
from .bodies import Bodies, BoolArray, FloatArray, IntArray
from .complementarity import components
from .contacts import ROUND_OFF, Pairs, distance_from_axes, length, touching
from .detection import MarginTwin
from .forecast import missed, next_impact
from .impacts import Impacts
from .paths import Paths
from .stepper import StepReport

_WAIT = 6.0  # how much faster than now an impact may make a body, in the guess of `_mind_neighbours`
_SHORTEST = 2.0**-20  # part of dt, of a window within which the order of impacts is checked
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
        slack = ROUND_OFF * distance_from_axes(start.position)
        if start.pulled:
            # The path of a thrown body leaves its chord.
            slack += (0.125 * start.dt**2) * length(start.acceleration)
        pairs = twin.candidates(start.position, displacement, slack)
        if len(pairs) == 0:
            return Motion(start.free_velocity, displacement, StepReport.without_contacts(start.time, bodies.items))
        return Rounds(bodies, start, twin, pairs, slack).run(self.max_rounds)


class Rounds:
    """The impacts of one step, in rounds. Contacts are numbered by their place in the list of pairs."""

    def __init__(self, bodies: Bodies, start: Start, twin: MarginTwin, pairs: Pairs, slack: FloatArray) -> None:
        self.start, self.twin, self.slack = start, twin, slack
        self.moves: BoolArray = bodies.dynamic
        self.paths = Paths(start, np.flatnonzero(bodies.dynamic))
        self.impacts = Impacts(bodies, start, self.paths)
        self.blocks = Blocks(self.impacts)
        self.may_stop = start.pulled or twin.shapes.lossy
        self.rows = np.arange(len(bodies))
        near = self._remember(pairs)
        if near is None:
            near = self._list(pairs, np.zeros(0, np.intp))
        if len(near):
            self._begin(near)

    def _list(self, pairs: Pairs, touch: IntArray) -> IntArray:
        """Take a list of pairs; `touch` are the keys of those that touch.

        Returns the contacts that are closed.
        """
        self.pairs = pairs
        self.time, self.gap = next_impact(pairs, self.paths, np.arange(len(pairs)), self.start.dt)
        self.bounces: IntArray = np.zeros(len(pairs), np.intp)
        self.touch: IntArray = np.searchsorted(pairs.key, touch)
        self._wait()
        self._join()
        position = self.start.position
        coarse = ROUND_OFF * (np.abs(position).max() + pairs.extent.max(initial=0.0))
        near = np.flatnonzero(self.gap <= coarse)
        return near[self.gap[near] <= touching(pairs.take(near), position)] if len(near) else near

    def _remember(self, pairs: Pairs) -> IntArray | None:
        """Take the forecasts of the last step, which hold for all bodies that nobody has touched since.

        Returns the contacts that may be closed; None if there are no forecasts for this list of pairs.
        """
        last = self.twin.memory
        if not isinstance(last, _Memory) or last.pairs is not pairs:
            return None
        start = self.start
        self.pairs, self.time, self.gap = pairs, last.time, last.gap
        self.bounces = np.zeros(len(pairs), np.intp)
        self.touch = np.zeros(0, np.intp)
        self._join()
        same = (last.position == start.position) & (last.velocity == start.velocity)
        if start.pulled or last.pulled:
            same &= last.acceleration == start.acceleration
        changed = ~(same[:, 0] & same[:, 1])
        near = last.touch
        again = np.flatnonzero(changed[pairs.row_a] | changed[pairs.row_b] | np.isnan(self.time))
        if len(again):
            self.time[again], self.gap[again] = next_impact(pairs, self.paths, again, start.dt)
            near = np.union1d(near, again)
        if len(near) == 0:
            return near
        some = pairs.take(near)
        return near[some.at(start.position).gap <= touching(some, start.position)]

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
        dt, rounds, windows = start.dt, 0, 1
        begin, end = 0.0, dt
        saved = self._save()
        while rounds < max_rounds:
            due = np.flatnonzero(self.time < end)
            if len(due) == 0:
                if end == dt:
                    break
                begin, end = end, min(dt, end + 2.0 * (end - begin))
                windows += 1
                saved = self._save()
                continue
            rounds += 1
            if not self._look_again(self._take(due)) and end - begin > _SHORTEST * dt:
                self._restore(saved)
                end = begin + 0.5 * (end - begin)
        t = np.full(len(self.rows), dt)
        displacement = paths.position(self.rows, t) - start.position
        self.blocks.finish()
        velocity = paths.rate(self.rows, t)
        self.twin.memory = _Memory(
            self.pairs, self.time - dt, self.gap, self.touch, start.position + displacement, velocity,
            paths.acceleration, paths.pulled,
        )  # fmt: skip
        report = self.impacts.report(self.pairs, rounds, windows, converged=len(due) == 0)
        return Motion(velocity, displacement, report)

    def _take(self, due: IntArray) -> IntArray:
        """One round: apply the impulses of the earliest contacts among `due`; the contacts it took."""
        pairs, t = self.pairs, self.time[due]
        a, b = self._labels(due)
        earliest = np.full(len(self.rows), np.inf)
        np.minimum.at(earliest, a, t)
        np.minimum.at(earliest, b, t)
        earliest[~self.moves] = np.inf  # a wall waits for nobody
        self._mind_neighbours(earliest)
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

    def _mind_neighbours(self, earliest: FloatArray) -> None:
        """Let bodies wait for impacts of neighbours that may send these into them before their own: (N,) instants.

        A guess from speeds and gaps, which saves rounds; `missed` finds what it did not foresee.
        """
        busy = earliest < np.inf
        both = np.flatnonzero(busy[self.pairs.row_a] & busy[self.pairs.row_b])
        row_a, row_b = self.pairs.row_a[both], self.pairs.row_b[both]
        speed = length(self.paths.velocity[row_a]) + length(self.paths.velocity[row_b])
        a, b = self.label[row_a], self.label[row_b]
        t_a, t_b = earliest[a], earliest[b]
        soon = np.flatnonzero(self.gap[both] < _WAIT * speed * np.abs(t_a - t_b))
        np.minimum.at(earliest, a[soon], t_b[soon])
        np.minimum.at(earliest, b[soon], t_a[soon])

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
        """Solve blocks (contacts, increasing) hit at the instants `seed`, and remember what touches on."""
        on = self.blocks.strike(self.pairs.take(block), seed, self._spent(block))
        self.touch = np.union1d(np.setdiff1d(self.touch, block), block[on])
        self.bounces[block] += 1
        self._join()

    def _wait(self) -> None:
        """What touches does nothing until something hits it, or until the force it rests on has to be found anew."""
        self.time[self.touch] = np.inf
        resting = self.blocks.resting
        if len(resting.key):
            self.time[np.searchsorted(self.pairs.key, resting.key)] = resting.until

    def _spent(self, contacts: IntArray) -> BoolArray:
        """Whether a contact has bounced so often that it has to stop, so that no dissipating bounce goes on forever."""
        spent: BoolArray = (self.bounces[contacts] >= _BOUNCES) & (self.pairs.elasticity[contacts] < 1.0)
        return spent

    def _look_again(self, taken: IntArray) -> bool:
        """Forecast anew what the bodies of the contacts just taken meet.

        Returns False if one of them would have met a body before an impact of that body that was taken already.
        """
        pairs, paths, dt = self.pairs, self.paths, self.start.dt
        both = np.concatenate((pairs.row_a[taken], pairs.row_b[taken]))
        rows = both[self.moves[both]]
        changed = np.zeros(len(self.rows), bool)
        changed[rows] = True
        moved = paths.position(rows, np.full(len(rows), dt)) - self.start.position[rows]
        if not self.twin.covers(rows, moved, self.slack[rows]):
            # An impulse sent a body farther than its margin: pairs that were not near may meet now.
            self._list(self.twin.widen(self.start.position), pairs.key[self.touch])
            pairs = self.pairs
            return not missed(pairs, paths, np.arange(len(pairs)), changed)
        again = np.flatnonzero(changed[pairs.row_a] | changed[pairs.row_b])
        if missed(pairs, paths, again, changed):
            return False
        self.time[again], self.gap[again] = next_impact(pairs, paths, again, dt)
        at_once = self.time[taken] <= np.maximum(paths.since[pairs.row_a[taken]], paths.since[pairs.row_b[taken]])
        self.time[taken[at_once & (self.bounces[taken] >= _BOUNCES)]] = np.inf
        self._wait()
        return True

    def _save(self) -> _Saved:
        paths, before = self.paths.copy(), self.paths.before.copy()
        return _Saved(
            paths, before, self.pairs, self.time.copy(), self.bounces.copy(), self.touch, self.blocks.resting,
            self.impacts.lock, len(self.impacts.log),
        )  # fmt: skip

    def _restore(self, saved: _Saved) -> None:
        self.paths.assign(saved.paths)
        self.paths.before.assign(saved.before)
        self.touch, self.blocks.resting = saved.touch, saved.resting
        self.impacts.lock = saved.lock
        del self.impacts.log[saved.log :]
        if self.pairs is saved.pairs:
            self.time[:], self.bounces[:] = saved.time, saved.bounces
            self._join()
        else:
            # The longer list serves the shorter paths as well.
            self._list(self.pairs, saved.pairs.key[saved.touch])


@dataclass(frozen=True)
class _Saved:
    """What a window of the step began with."""

    paths: Paths
    before: Paths
    pairs: Pairs
    time: FloatArray
    bounces: IntArray
    touch: IntArray
    resting: Resting
    lock: float
    log: int


@dataclass(frozen=True)
class _Memory:
    """What a step knows about the next: when its pairs meet, counted from the end, if the bodies go on as they are."""

    pairs: Pairs
    time: FloatArray
    gap: FloatArray
    touch: IntArray
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    pulled: bool
