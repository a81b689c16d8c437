"""Many steps in one call, as `..impacts.run`, with joints."""

from __future__ import annotations

from ..arrays import FloatArray, IntArray
from ..compiled import Table, kernel
from ..impacts.midstep import begin_together
from ..impacts.run import after_step, before_step, next_rollout
from ..model.joints import joints_of
from ..model.run import AFTER, BETWEEN, WITHIN, run_arrays_of
from ..model.scene import scene_of
from .loop import resume_jointed, start_jointed
from .together import resume_together_jointed


@kernel
def run_jointed(
    TABLE: Table, JOINTS: Table, ARRAYS: Table, STATES: FloatArray, WALK: IntArray, EXTRA: FloatArray, ENDS: FloatArray,
    USUAL: FloatArray, lossy: bool, together: bool,
) -> int:  # fmt: skip
    """Arguments and answer as of `..impacts.run.run`."""
    A, J, F = scene_of(TABLE), joints_of(JOINTS), run_arrays_of(ARRAYS)
    RUN = F.RUN
    while True:
        while RUN.done < RUN.until:
            if RUN.stage == BETWEEN:
                before_step(A, F, STATES, WALK)
                RUN.bits = start_jointed(A, J, STATES, WALK, EXTRA, RUN.dt, RUN.gravity_x, RUN.gravity_y, RUN.left_over)
                if RUN.bits < 0:
                    return RUN.bits
                if together:
                    begin_together(A)
                RUN.stage = WITHIN
            if RUN.stage == WITHIN:
                if together:
                    status = resume_together_jointed(A, J, STATES, WALK, EXTRA, ENDS, USUAL, RUN.bits)
                else:
                    status = resume_jointed(A, J, STATES, WALK, EXTRA, ENDS, lossy, RUN.bits)
                if status < 0:
                    return status
                RUN.bits, RUN.stage = status, AFTER
            status = after_step(A, F, STATES)
            if status < 0:
                return status
        if not next_rollout(F):
            return RUN.all_bits
