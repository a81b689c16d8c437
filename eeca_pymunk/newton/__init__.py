"""Newton: the implicit equations of one component of jointed bodies, and Newton's iteration for them.

In: a `Workspace` with the component's bodies, joints, limits that act, and the length of a step. Out: velocities and
impulses that satisfy the balance of momentum and the joints to round-off, or False; or the velocities with which the
component responds to given impulses.

Open first `rows.py`, the equations of all ten joints (`points.py`, `angles.py`, `springs.py`), then `solve.py`, the
iteration. `systems.py` builds its linear systems from `entries.py` and `saturation.py` (bounded impulses);
`banded.py` (bodies and rows together), `condensed.py` (bodies alone) and `dual.py` (rows alone) solve them. `motion.py`
moves bodies by their velocities; `response.py` has the response to impulses, `effort.py` the work of all this.

Symbols: h is the length of a step or of a part of one, v0 and v1 the velocities at its start and end, and x = h v_m = h
(v0 + v1)/2 the *way* of a body, (length, length, rad). A joint has rows: functions g of the poses, lengths or angles,
which it keeps at a target; J is a row's discrete gradient over the step, g1 - g0 = J x (`rows`), G = dg1/dx its slope
at the end (`slopes`). lam is the impulse along a row, J^T lam that on the bodies (`force`, an impulse too). J turns
with the bodies, and J^T lam with it: the joint *bends*. STIFF is the derivative of J^T lam by x at fixed lam; for
springs, whose lam depends on x, the total one. M are the masses and moments, mobilities their inverses, roots the
square roots of mobilities. Where there is no time, as for POSES and SPEEDS, h is 2, so that x = v0 + v1.

Names of arguments: k a joint of the component, r one of its rows, i a body, c its direction (0 along x, 1 along y, 2
about its centre of mass). `link`, `hinge`, `local` are the component's COUPLING, HINGE and LOCAL. `what` is solved for:
STEP, POSES, SPEEDS or LINEAR_STEP; `system`: WHOLE, CONDENSED or DUAL; `build`: whether the matrix is built, or the
right side alone; `give`: compliance of the joints over h², 0 if they hold exactly. A row *acts* unless it is that of a
limit on which its joint does not stand (`entries.acts`).
"""
