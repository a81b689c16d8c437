"""rollout: copies of one scene from many states, in compiled code, on threads."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from queue import SimpleQueue
from typing import Literal, overload

import numpy as np
import numpy.typing as npt
from tqdm import tqdm

from .arguments import check_count
from .arrays import FloatArray
from .compiled.targets import processors
from .datasets import Rollouts
from .errors import UnsupportedFeature
from .events import Events
from .recorder import versions
from .reentry import Entered, refuse_within
from .rolling import Copy, Job, Rolling, roll_in_python
from .runs import RunningStepper
from .space.bodies import moving
from .space.constraints import ratchets_of
from .stepper import check_dt

_PIECES_PER_THREAD = 8  # largest number of pieces of work for each thread, so that threads end at about the same time
_STEPS_PER_PIECE = 4096  # least number of steps of a piece, unless there would be fewer pieces than threads


@overload
def rollout(
    stepper: RunningStepper, states: npt.ArrayLike, steps: int, dt: float, every: int = 1,
    controls: npt.ArrayLike | None = None, threads: int | None = None, progress: bool = False,
    full: Literal[False] = False,
) -> FloatArray: ...  # fmt: skip
@overload
def rollout(
    stepper: RunningStepper, states: npt.ArrayLike, steps: int, dt: float, every: int = 1,
    controls: npt.ArrayLike | None = None, threads: int | None = None, progress: bool = False,
    *, full: Literal[True],
) -> Rollouts: ...  # fmt: skip
def rollout(
    stepper: RunningStepper, states: npt.ArrayLike, steps: int, dt: float, every: int = 1,
    controls: npt.ArrayLike | None = None, threads: int | None = None, progress: bool = False, full: bool = False,
) -> FloatArray | Rollouts:  # fmt: skip
    """The paths of K copies of a scene from K states. Each is bit by bit that of `stepper.set_state(states[k])` and
    `steps` calls of `stepper.step(dt)`. The space and its stepper are not changed.

    Args:
        stepper: an EECA, of the scene.
        states: (K, b, 6) position, angle, velocity and spin of the b bodies that are not static, in the order of
            `space.bodies`; length, rad, per time.
        steps, dt: number of steps, > 0; time, > 0.
        every: number of steps from frame to frame, so that there are T = steps // every frames. Steps after the last
            frame are not taken.
        controls: (K, T, b, 3) force (2) at the centre of mass and torque of each body, constant over the steps that end
            in a frame.
        threads: their number; that of the processors if None. The result does not depend on it.
        progress: show a progress bar.
        full: also return ledgers, impacts, and which steps did not converge.

    Returns:
        (K, T, b, 6) frames; a `Rollouts` if `full`.

    Raises:
        ValueError: a shape of an array is wrong, or a number is or would become infinite or NaN.
        UnsupportedFeature: functions are called within steps, and the space cannot be copied, see below.
        RuntimeError: called by a function within a step, or while another thread steps the space or rolls it out.

    If `stepper.run` is a Python loop, so is this, in one thread: on the space itself, whose state is restored
    afterwards, or, if functions are called within steps, on a copy of it by pickle. So it is with ratchets, as each
    state sets their notches.
    """
    if not isinstance(stepper, RunningStepper):
        raise TypeError(f"{type(stepper).__name__} has no rollouts: give an EECA")
    refuse_within(stepper.space)
    steps, every, dt = check_count("steps", steps), check_count("every", every), check_dt(dt)
    if steps == 0 or every == 0 or dt == 0.0 or steps < every:
        raise ValueError(f"steps = {steps}, every = {every}, dt = {dt}: give numbers > 0, every <= steps")
    bodies = moving(stepper.space)
    b, T = len(bodies), steps // every
    start = np.ascontiguousarray(states, float)
    if start.ndim != 3 or start.shape[1:] != (b, 6):
        raise ValueError(
            f"states of shape {start.shape}: give (K, {b}, 6), position, angle, velocity, spin of each body"
        )
    K = len(start)
    push = None if controls is None else np.ascontiguousarray(controls, float)
    if push is not None and push.shape != (K, T, b, 3):
        raise ValueError(f"controls of shape {push.shape}: give ({K}, {T}, {b}, 3), force and torque of each body")
    for name, array in (("states", start), ("controls", push)):
        if array is not None and not np.isfinite(array).all():
            at = tuple(np.argwhere(~np.isfinite(array))[0].tolist())
            raise ValueError(f"{name}[{at}] is {array[at]}: give finite numbers")
    count = processors() if threads is None else check_count("threads", threads, 1)
    job = Job(
        start, push, T * every, every, dt, np.zeros((K, T, b, 6)), np.zeros((K, T, 6)), np.zeros(K, np.int64), full
    )
    bar = tqdm(total=K, desc="rollout", unit="rollout", disable=not progress)
    with bar, Entered(stepper.space):  # for all rollouts together: they share copies, or step the space itself
        if stepper.compiles() and not ratchets_of(stepper.space):
            events = _on_threads(stepper, job, min(count, max(K, 1)), bar.update)
        else:
            events = _in_python(stepper, job, bar.update)
    if not full:
        return job.frames
    first = np.cumsum([0, *map(len, events)])
    parameters = {"steps": steps, "dt": dt, "every": every, "model": stepper.model}
    parameters |= {"controlled": push is not None, **versions()}
    return Rollouts(start, job.frames, job.ledger, job.unmet, Events.joined(events), first, parameters=parameters)


def certify(
    stepper: RunningStepper, rollouts: Rollouts, threads: int | None = None, progress: bool = False,
    controls: FloatArray | None = None,
) -> FloatArray:  # fmt: skip
    """Estimate the errors of the frames of rollouts: they are computed again with half the time step and compared.

    For a method of order p >= 1 and small dt the error is 2^p / (2^p - 1) <= 2 times the difference. Where the method
    is exact (impacts of disks, free flight) the two differ by round-off, and the difference measures how it grows from
    impact to impact.

    Args:
        controls: (K, T, b, 3) those of the rollouts, which do not store them; None if they had none.

    Returns:
        (K,) length, twice the largest difference of a position in any frame; also stored as `rollouts.error`.

    Raises:
        ValueError: the rollouts had controls and none are given, or the reverse.
    """
    controlled = rollouts.parameters.get("controlled", controls is not None)  # unknown of older files
    if controlled and controls is None:
        raise ValueError("these rollouts had controls, which they do not store: give certify the same, as controls=...")
    if not controlled and controls is not None:
        raise ValueError("these rollouts had no controls: give certify none")
    steps, dt, every = (rollouts.parameters[name] for name in ("steps", "dt", "every"))
    finer = rollout(stepper, rollouts.states, 2 * steps, 0.5 * dt, 2 * every, controls, threads, progress)
    distance = np.linalg.norm(finer[..., :2] - rollouts.frames[..., :2], axis=-1)
    rollouts.error = 2.0 * distance.max(axis=(1, 2), initial=0.0)
    return rollouts.error


def _on_threads(stepper: RunningStepper, job: Job, threads: int, done: Callable[[int], object]) -> list[Events]:
    """All rollouts in compiled code on threads; returns the impacts of each."""
    K = len(job.states)
    count = max(threads, min(threads * _PIECES_PER_THREAD, K * job.steps // _STEPS_PER_PIECE))
    size = max(1, -(-K // count))
    pieces = [(k, min(k + size, K)) for k in range(0, K, size)]
    free: SimpleQueue[Copy] = SimpleQueue()
    for one in Rolling.of(stepper, job.dt).copies(threads):
        free.put(one)

    def roll(piece: tuple[int, int]) -> list[Events]:
        one = free.get()
        try:
            return one.roll(job, *piece)
        finally:
            free.put(one)

    found = []
    with ThreadPoolExecutor(threads) as pool:
        try:
            for piece, events in zip(pieces, (map if threads == 1 else pool.map)(roll, pieces), strict=True):
                found += events
                done(piece[1] - piece[0])
        except BaseException:
            pool.shutdown(wait=True, cancel_futures=True)
            raise
    return found


def _in_python(stepper: RunningStepper, job: Job, done: Callable[[int], object]) -> list[Events]:
    """All rollouts by a Python loop; returns the impacts of each. The space is restored, or copied first."""
    if stepper.calls():
        return roll_in_python(_twin(stepper), job, done)
    state = stepper.get_state()
    try:
        return roll_in_python(stepper, job, done)
    finally:
        stepper.set_state(state)


def _twin(stepper: RunningStepper) -> RunningStepper:
    """A copy of a stepper and its space."""
    try:
        twin: RunningStepper = pickle.loads(pickle.dumps(stepper))
    except Exception as error:
        raise UnsupportedFeature(
            f"rollouts of a space in which functions are called step a copy of it, and pickle makes none ({error}): "
            "give functions that stand in a module"
        ) from error
    return twin
