"""Energy that joints have given in a step: how much it is, and how the motion pays it back.

| status of the step | what joints have given | paid in | if the motion cannot pay |
|---|---|---|---|
| EXACT, NEARLY | what exact rows have (`gain_of_rows`) | `repay`, on the ladder | the rung fails; or see below |
| ELASTIC, UNHELD | all that nothing else explains (`close_ledger`) | `take_gain` | bodies move as one |

Where the motion is too slow to pay what exact rows have given, bodies keep a gain that is round-off; of a larger one
(`gain_unpaid`) they move as one, too (`unheld.stop_joints`). `lock` takes energy from the motion. Before, momenta and
ledger are put right (`clear_errors`). Without a frame of the supports (`frame`) these may do any work: the ledger gives
it to them, and nothing is a gain.
"""

from __future__ import annotations

from ..compiled import nonallocating
from ..model.joint_steps import ELASTIC, UNHELD
from ..model.joints import Workspace
from ..model.parameters.joints import GAIN_KEPT, JOINT_GAIN, JOINT_TOLERANCE, LINEAR_APART, REPAID
from .bounds import inactive, passed_side
from .closing import farthest, fit_to_supports
from .correct import NOW, SAVED, kinetic_of
from .frame import move_apart
from .ledger import close_ledger, unexplained
from .lock import lock_energy, restore_momenta
from .start import compute_rows, load_of
from .unheld import stop_joints


@nonallocating
def gain_of_rows(W: Workspace, own: bool) -> float:
    """The energy that exact rows have given in a step. What limits lose pays for round-off of joints that hold, but not
    for closing what an earlier step left apart (`own`)."""
    part = W.J.RUNG_LEDGER
    return float(part.closed - (0.0 if own else max(part.limited, 0.0)))


@nonallocating
def clear_errors(W: Workspace, h: float, extent: float) -> None:
    """Restore the momenta of a step, and close its ledger where it is open by more than round-off of the energy and of
    the work of forces over the size `extent`: impulses that are large change both by their round-off, and their works
    cancel only up to that."""
    part, load = W.J.RUNG_LEDGER, load_of(W, h, extent)
    least = JOINT_GAIN * (kinetic_of(W, SAVED) + kinetic_of(W, NOW) + load)
    part.closed += restore_momenta(W, h, False)
    apart = unexplained(W) - (part.supports + part.closed - part.limited)
    if not abs(apart) <= least:
        close_ledger(W)


@nonallocating
def repay(W: Workspace, h: float, extent: float, own: bool) -> bool:
    """Whether exact rows have given no energy, or little, which is then taken from the motion.

    Joints that an earlier step left apart (`own`) close at once; if that gives much energy beside what was there, the
    step fails. Other rows hold to round-off e of their places, and give e times their impulse over h: more in shorter
    steps. What is taken of a gain that is much larger than the energy has its round-off: the rest is taken again. What
    rows have taken, more than round-off of the energy, is lost: nothing outside has it.
    """
    part, before = W.J.RUNG_LEDGER, kinetic_of(W, SAVED)
    for turn in range(2):
        clear_errors(W, h, extent)
        gain = gain_of_rows(W, own)
        if not gain > 0.0 or move_apart(W):
            break
        if own and not gain <= REPAID * before:
            return False
        if not (gain > JOINT_GAIN * (before + kinetic_of(W, NOW)) or (own and turn == 0)):
            break
        part.closed -= lock_energy(W, gain, part)
    if -part.closed > JOINT_GAIN * (before + kinetic_of(W, NOW)):
        part.limited, part.closed = part.limited - part.closed, 0.0
    return True


@nonallocating
def gain_unpaid(W: Workspace, h: float, extent: float, own: bool) -> bool:
    """Whether exact rows have given energy that the motion could not pay: more than GAIN_KEPT of what bodies had and of
    the work of forces over the size `extent` of the component, and more than that of the velocities which round-off of
    places is over h. Not where joints need not be exact yet (PROGRESS.near)."""
    if W.J.PROGRESS.near > 0.0:
        return False
    gain, mass = min(gain_of_rows(W, own), unexplained(W) - W.J.RUNG_LEDGER.frame_work), 0.0
    if not gain > 0.0 or move_apart(W):
        return False
    for i in range(W.bodies):
        mass += 1.0 / W.J.LOCAL[i].mobility[0] if W.J.LOCAL[i].mobility[0] > 0.0 else 0.0
    noise = mass * (JOINT_TOLERANCE * extent / h) ** 2
    had = kinetic_of(W, SAVED) + load_of(W, h, extent)
    return bool(gain > noise + GAIN_KEPT * had)


@nonallocating
def passes_limits(W: Workspace) -> bool:
    """Whether a joint that stands on no limit is beyond one at the present poses."""
    compute_rows(W)
    for k in range(W.joints):
        if inactive(W.link, k) and passed_side(W, k, LINEAR_APART) != 0:
            return True
    return False


@nonallocating
def pay_all(W: Workspace, h: float, extent: float) -> bool:
    """Close the ledger of a step whose joints did not hold exactly, and take its gain from the motion; returns whether
    what is left of it is round-off of the kinetic energies before and after, and of the work of forces over the size
    `extent`: what hangs at rest cannot pay for that.

    Joints that close within a short h make bodies fast, and the lock then takes most of this, and leaves its round-off,
    of momenta too: both are put right once more.
    """
    part = W.J.RUNG_LEDGER
    for _ in range(2):
        clear_errors(W, h, extent)
        close_ledger(W)
        if part.closed > 0.0:
            lock_energy(W, part.closed, part)
            close_ledger(W)
    least = JOINT_GAIN * (kinetic_of(W, SAVED) + kinetic_of(W, NOW) + load_of(W, h, extent))
    return not part.closed > least


@nonallocating
def take_gain(W: Workspace, h: float, extent: float, status: int, own: bool, before: float) -> int:
    """Take from the motion what joints have given in a step of this status, if `repay` has not; returns the status.

    If the motion cannot pay, or linear rows leave joints farther apart than `before` by more than LINEAR_APART, or pass
    a limit, all bodies move as one: UNHELD; of elastic and linear steps only if supports do not move apart. `own`: see
    `repay`.
    """
    if fit_to_supports(W):
        clear_errors(W, h, extent)
    if status < ELASTIC:
        fails = gain_unpaid(W, h, extent, own)
    else:
        fails = not pay_all(W, h, extent)
        if status == UNHELD and not fails:
            fails = not farthest(W) <= before + LINEAR_APART or passes_limits(W)
        fails = fails and not move_apart(W)
    if fails:
        stop_joints(W, h)
    return UNHELD if fails else status
