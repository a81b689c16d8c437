"""Breaks kernels one at a time, in a copy of the package, and shows that a named quick test fails for each.

By hand, not in CI:    python tests/mutations.py [WORD]    (only those whose name has this word)

Kernels run as plain Python, so that nothing is compiled. All named tests have to pass in the whole copy first. The
exit status is the number of mutations that no test has noticed, or that no longer fit the sources.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
COPIED = ("eeca_pymunk", "scenes", "comparisons", "tests", "pyproject.toml")
LIMIT = 100  # s for a test; what is broken may never end


@dataclass(frozen=True)
class Mutation:
    """Where `old` stands in a file of the package, once, and `new` is wrong; the test (file, and -k) that must fail."""

    name: str
    file: str
    old: str
    new: str
    test: str
    only: str


MUTATIONS = (
    # Sleeping.
    Mutation("sleeping: what a kinematic body carries", "sleepers.py", "            awake[PAIRS[p, 1]] = 1",
             "            awake[PAIRS[p, 0]] = 1", "space/test_sleeping.py", "groups_sleep"),
    # What no contact of an interval tells.
    Mutation("corrections: through a wall that is not touched", "islands/intervals.py",
             "            if through and k > n:", "            through = False\n            if through and k > n:",
             "islands/test_lifting.py",
             "lifted_through or turned_through"),
    Mutation("straight chains: a kinematic body that moves", "space/joints.py", "None if any(at[3:]) else at[:3]",
             "at[:3]", "jointed/test_straight.py", "kinematic"),
    # Arbiters.
    Mutation("arbiters: pairs in both orders", "space/arbiters.py", "append((e, -1.0))", "append((e, 1.0))",
             "space/test_arbiters.py", "both_orders"),
    Mutation("arbiters: making them calls handlers", "space/private/rest.py",
             "held = private.functions(space)", "held = []", "space/test_arbiters.py", "calls_no_handler"),
    # Edits.
    Mutation("edits: surfaces wake what touches them", "impacts/edits.py", "A.MEMBER[touching.root].rest = CHANGED",
             "A.MEMBER[touching.root].rest = AT_REST", "space/test_edited_values.py", "slides_when_friction_falls"),
    Mutation("taking over: a lost contact wakes nothing", "impacts/taking_over.py",
             "        if first >= 0:\n            disturb(A, first)\n        for s in (a, b):\n            if s >= 0:",
             "        for s in (a, b):\n            if False:", "space/test_kept_results.py", "fall_where_their_floor"),
    Mutation("taking over: forces are lost", "impacts/taking_over.py", "if same_pair(SHAPES, a, b):\n            force",
             "if False:\n            force", "space/test_kept_results.py", "changes_nothing[wall-False-False-0]"),
    Mutation("edits: contacts that filters forbid remain", "impacts/edits.py", "and may_collide(A, a, b)",
             "and True", "space/test_kept_results.py", "fall_where_their_floor"),
    Mutation("rest: what a kinematic body lies in stays", "islands/building.py", "wake_penetrated(A)", "pass",
             "space/test_kept_results.py", "lifts_it"),
    # Flight and times of impact.
    Mutation("flight: a half is missing", "geometry/flight.py", "half = 0.5 * s", "half = s",
             "geometry/test_gap.py", "parabola"),
    Mutation("flight: sign of an acceleration", "geometry/flight.py", "BODY[i].vx + s * BODY[i].ax",
             "BODY[i].vx - s * BODY[i].ax", "closures/test_time_of_impact.py", "different_forces"),
    Mutation("times: a clock's way is missing", "prediction/impact_times.py",
             "(BODY[j].vx + h * ax) - (BODY[i].vx + g * ax), (BODY[j].vy + h * ay) - (BODY[i].vy + g * ay)",
             "BODY[j].vx - BODY[i].vx, BODY[j].vy - BODY[i].vy",
             "prediction/test_impact_times.py", "own_clocks"),
    Mutation("times: factor 2 of a parabola's root", "prediction/roots.py", "return 2.0 * g / (math.sqrt(D) - w)",
             "return g / (math.sqrt(D) - w)", "prediction/test_impact_times.py", "flat_root"),
    Mutation("times: sign in the root of two disks", "prediction/roots.py", "(reach + cross)) - b)",
             "(reach + cross)) + b)", "prediction/test_impact_times.py", "grazing"),
    Mutation("limits: what leaves its bound meets it again at once", "joints/bounds.py",
             "return -0.5 * (before + root) / curvature if curvature < 0.0 else h", "return 0.0",
             "joints/test_limits.py", "opens_first"),
    Mutation("limits: what is let go is never held", "joints/bounds.py", "link[k].let_go == side and", "False and",
             "joints/test_limits.py", "another"),
    Mutation("limits: targets of free ones", "joints/closing.py", "if acts(link, k, r) else 0.0", "if True else 0.0",
             "joints/test_limits.py", "closing"),
    Mutation("islands: contacts that have ended are kept", "impacts/loop.py",
             "if few < 0 or COUNT.pushes > 2 * few + _MORE_CONTACTS:", "if False:",
             "islands/test_large_steps.py", "many_intervals"),
    Mutation("limits: what is apart has passed its bound", "joints/bounds.py", "if side * left > 0.0:", "if False:",
             "joints/test_limits.py", "left_apart"),
    Mutation("limits: round-off lets go", "joints/limits.py", "    if at_once:", "    if False:",
             "joints/test_limits.py", "circles and 4e-13-1.0"),
    Mutation("limits: what is let go stays so, though it closes", "joints/correct.py",
             "release(W, SPEEDS) or hold_closing(W, False)", "release(W, SPEEDS)", "joints/test_bounds.py", "fit_all"),
    Mutation("limits: each hop is met", "joints/limits.py", "S.hopped < W.joints and bounds.", "False and bounds.",
             "joints/test_bounds.py", "a_few_times"),
    Mutation("limits: none takes part in an impact", "impacts/joint_impact.py",
             "or not activate_limits(A, J, block, groups, t)", "or True", "impacts/test_joint_impact.py", "a_wall"),
    Mutation("limits: displacements pass them at the wrong side", "joints/correct.py",
             "a, b) < -room:", "a, b) > room:", "jointed/test_correction.py", "along_limits"),
    Mutation("impacts: joints of bounded force hold", "joints/plan.py",
             "model.BOUNDED if bounded else 0", "0", "jointed/test_still.py", "flies_into"),
    Mutation("motors: impulses without bounds", "newton/saturation.py",
             "sticks = low <= p0 <= high if rows == 1 else size <= bound", "sticks = True",
             "joints/test_limits.py", "does_not_hold_what_leaves"),
    Mutation("rest: what ends with a velocity", "jointed/rest.py", "rest.end_vx, rest.end_vy, rest.end_spin, reach)",
             "0.0, 0.0, 0.0, reach)", "jointed/test_still.py", "damping"),
    Mutation("rest: other laws of springs wake nothing", "jointed/rest.py", "if joint.push != kept.push or",
             "if False and",
             "jointed/test_rest.py", "law_of_a_spring"),
    Mutation("rest: what was hit stays at rest", "jointed/rest.py", "        set_awake(A, root)\n", "        pass\n",
             "jointed/test_rest.py", "hit_moves_it"),
    Mutation("rest: edited joints, and partners that begin to move, wake nothing", "jointed/rest.py",
             "return has_moving_partner(A, J, s)", "return False", "jointed/test_rest.py", "partner_that_starts"),
    Mutation("rest: other laws of pairs wake nothing", "islands/at_rest.py", "= rules != A.PAR.rules, rules",
             "= False, rules", "islands/test_at_rest.py", "handler"),
    Mutation("support: loads that change within a step are forgotten", "impacts/step.py", "    renew_support(A)\n", "",
             "islands/test_support.py", "hold_its_weight"),
    Mutation("support: what is hit keeps the forces of the start of the step", "islands/accounting.py",
             "    if t > 0.0:\n        renew_loads", "    if t > 1e300:\n        renew_loads",
             "programs/test_momenta.py", "until_it_is_hit"),
    Mutation("support: four factorisations for what has pressed", "islands/loads.py",
             "unsupported(A, i, t, STATICS_FACTORS)",
             "unsupported(A, i, t, 4)", "programs/test_momenta.py", "many_impacts"),
    Mutation("turned: contacts do not report it", "islands/turned.py",
             "        if VIA[q] >= 0:", "        if VIA[q] >= 10**9:",
             "programs/test_momenta.py", "report_the_rotation"),
    Mutation("correction: all bodies of an island turn together", "contacts/correction.py",
             "        if GROUP[q] == most:", "        if True:", "contacts/test_correction.py", "press_on_nobody"),
    Mutation("correction: whom others push aside is in no group", "contacts/correction.py",
             "if L[i, 0] > 0.0 or MU[i] > 0.0:", "if L[i, 0] > 0.0:", "islands/test_free_crowds.py", "False"),
    Mutation("jointed: whom others push aside is in no group", "jointed/correction.py",
             "if L[i, 0] > 0.0 or MU[i] > 0.0:", "if L[i, 0] > 0.0:", "islands/test_free_crowds.py", "True"),
    Mutation("jointed: springs connect bodies at an impact", "jointed/groups.py", "-1 if loose else s", "s",
             "jointed/test_columns.py", "springs_connect"),
    Mutation("jointed: walls turn in one interval", "jointed/solve.py", "if shorter < h and not last:", "if False:",
             "contacts/test_turning.py", "joints_connect and 0.4"),
    Mutation("jointed: what joints do not allow opens a gap", "jointed/meet.py",
             "            S.rate, S.t = allowed, S.least\n", "            pass\n", "jointed/test_meet.py",
             "do_not_allow"),
    Mutation("jointed: what is carried along passes limits", "joints/bounds.py",
             "passed_side(W, k, JOINT_TOUCH)", "passed_side(W, k, 1e9)",
             "jointed/test_meet.py", "carries_along"),
    Mutation("work: the search for an impact goes on", "jointed/meet.py", "        if spent:\n            break\n", "",
             "jointed/test_work.py", "search_for_an_impact"),
    Mutation("work: gaps of pairs that are left out", "islands/candidates.py", "max(gaps - p, 0)", "0",
             "jointed/test_work.py", "leaves_out"),
    Mutation("columns fit round-off", "jointed/broyden.py", "    clear_round_off(interval, ERROR)\n", "",
             "jointed/test_convergence.py", "columns_answer"),
    # Loop.
    Mutation("loop: a new path is not predicted", "impacts/loop.py",
             "if o < 0 or STATE[j].version != STATE[i].known:", "if o < 0:",
             "impacts/test_loop.py", "twenty_disks"),
    Mutation("loop: the partner of an impact is not predicted", "impacts/loop.py",
             "one, two = a, b if o < disks else -1", "one, two = a, -1", "impacts/test_loop.py", "twenty_disks"),
    Mutation("disks: the next impact is lost", "prediction/disks.py", "if later != NOTHING and other < 0:",
             "if False:", "prediction/test_disks.py", "kept_over"),
    Mutation("disks: an instant of an earlier step is kept", "prediction/disks.py", "A.BODY[i].due = due = t", "pass",
             "prediction/test_disks.py", "kept_over"),
    Mutation("loop: margins are left too late", "prediction/next_event.py", "(root - b) / squared",
             "(root + b) / squared",
             "prediction/test_heap.py", "nobody_leaves"),
    Mutation("loop: the acceleration of what leaves a margin does not count", "prediction/next_event.py",
             "m - 0.5 * g * t * t", "m", "prediction/test_heap.py", "nobody_leaves"),
    Mutation("loop: an orbit's arm does not count", "prediction/next_event.py", "g, m - arm)",
             "g, m)", "prediction/test_heap.py", "nobody_leaves"),
    Mutation("loop: walls of a container count many times in margins", "pairs/margins.py",
             "if squared * part > 1.0:", "if False:", "pairs/test_lists.py", "container_counts"),
    Mutation("prediction: what is beyond a face closes it again", "prediction/turning.py",
             "if opening(one, two, nx, ny, px, py) >= 0.0:", "if True:", "prediction/test_turning.py", "free_end"),
    Mutation("prediction: what a fast shape sweeps is its core", "prediction/turning.py",
             "A.SHAPE[b].extent if fast_b else", "A.SHAPE[b].rounding if fast_b else", "prediction/test_turning.py",
             "fast_shapes"),
    Mutation("work: looks at many vertices count as others", "prediction/work.py",
             "1.0 + (p * q if min(p, q) < MANY_CORNERS else 6.0 * (p + q)) / VERTICES_LOOK", "1.0",
             "prediction/test_turning.py", "many_vertices"),
    Mutation("loop: walls of a slow container have orbits", "pairs/grid.py", "if turn > 2.0 * math.pi and turn",
             "if turn", "impacts/test_loop.py", "turns_slowly"),
    Mutation("loop: only impacts see that the budget is spent", "impacts/loop.py",
             "if o == RENEW or COUNT.work > most:", "if o == RENEW:", "test_unmet.py", "meets_nothing"),
    Mutation("islands: only external accelerations press elastic contacts", "islands/membership.py",
             "pressed = max(closing, present) > 0.0", "pressed = closing > 0.0", "islands/test_support.py", "belt"),
    # Impact law.
    Mutation("impact: e squared", "contacts/single.py", "lam = (1.0 + e) *", "lam = (1.0 + e * e) *",
             "closures/test_time_of_impact.py", "inelastic_bounce"),
    Mutation("impact: opening contacts are not kept open", "rows/build.py",
             "ROWS[i].target = -ROWS[i].elasticity * u if u < 0.0 else -u",
             "ROWS[i].target = -ROWS[i].elasticity * u if u < 0.0 else 0.0", "rows/test_blocks.py", "independent"),
    Mutation("impact: sign of an arm", "rows/build.py", "xb * ny - yb * nx, xa", "yb * nx - xb * ny, xa",
             "rows/test_build.py", "rigid"),
    # Friction.
    Mutation("friction: the spin of a disk counts the wrong way", "contacts/single.py", "- r_i * BODY[i].spin",
             "+ r_i * BODY[i].spin", "oracles/test_impacts.py", "rough and floor"),
    Mutation("friction: no bound mu lam", "contacts/single.py", "beta = min(max(-slip / turning, -mu * lam), mu * lam)",
             "beta = -slip / turning", "oracles/test_impacts.py", "rough and floor"),
    Mutation("friction: sign of a tangential arm", "rows/build.py", "xa * nx + ya * ny,",
             "xa * nx - ya * ny,", "rows/test_build.py", "rigid"),
    Mutation("friction: slips against less than mu lam", "rows/coulomb.py",
             "beta = sign * mu * lam\n                if sign", "beta = 0.9 * sign * mu * lam\n                if sign",
             "rows/test_direct.py", "local_law"),
    Mutation("friction: may give energy", "rows/coulomb.py", "if T * (s * T + p) + c > 0.0:", "if False:",
             "rows/test_blocks.py", "coulomb"),
    # Sustained contacts.
    Mutation("persistent: bounces never end", "contacts/targets.py", "-e * min(u, 0.0) < 0.5 * press",
             "-e * min(u, 0.0) < 0.0 * press", "contacts/test_one_body.py", "bounces_end"),
    Mutation("persistent: soft landing by half a gap", "contacts/targets.py", "close = -u - 2.0 * ROWS[i].gap / h",
             "close = -u - ROWS[i].gap / h", "contacts/test_one_body.py", "comes_down_slowly"),
    Mutation("persistent: half of the pull", "contacts/interval.py", "contacts.L[:m], isle.V + h",
             "contacts.L[:m], isle.V + 0.5 * h", "contacts/test_one_body.py", "slides"),
    Mutation("persistent: geometry of the start", "contacts/geometry.py", "isle.POSE + 0.5 * h * isle.V",
             "isle.POSE + 0.0 * isle.V", "contacts/test_one_body.py", "second_order"),
    Mutation("correction: it costs nothing", "contacts/correction.py",
             "if not work + square > budget + ", "if True or budget > ", "contacts/test_piles.py", "push_out"),
    Mutation("correction: it turns a free island", "contacts/correction.py", "V[i, at + 2] += turn",
             "V[i, at + 2] -= turn", "contacts/test_piles.py", "free_island"),
    # Joints.
    Mutation("joints: sign of a lever", "newton/points.py",
             "-mx, -my, -lever_a * (rax * my - ray * mx)", "-mx, -my, lever_a * (rax * my - ray * mx)",
             "newton/test_equations.py", "discrete_gradients"),
    Mutation("joints: end instead of mean velocity", "newton/motion.py",
             ".way[c] = 0.5 * h * (local[i].v0[c] + local[i].v1[c])", ".way[c] = h * local[i].v1[c]",
             "joints/test_linkages.py", "published_place"),
    Mutation("joints: force of a spring at the end", "newton/springs.py", "return 0.5 * (f0 + f1)", "return f1",
             "joints/test_kinds.py", "spring_on_a_line"),
    Mutation("joints: damping as of the midpoint rule", "newton/rows.py",
             "return np.tanh(damping * rate) / rate if rate > 0.0 else damping", "return damping",
             "joints/test_kinds.py", "stiff_damper"),
    Mutation("joints: a rope that pushes", "joints/correct.py", "if pull > max(", "if -pull > max(",
             "joints/test_limits.py", "thrown_inwards"),
    Mutation("joints: parts of order 4", "joints/ladder.py", "(1.0 - 4.0 * SUZUKI) * h", "(1.0 - 3.0 * SUZUKI) * h",
             "joints/test_linkages.py", "published_place"),
    # Ledger and lock.
    Mutation("ledger: factor 1/2 of a bounce", "contacts/single.py",
             "PAR.restitution += 0.5 * lam", "PAR.restitution += lam",
             "oracles/test_impacts.py", "comes_to_rest_is_booked"),
    Mutation("equilibrium: one edge of the cone", "rows/cones.py", "slope = mu if side == 0 else -mu",
             "slope = mu", "rows/test_equilibrium.py", "linear_programming"),
    Mutation("joints: bodies are held where they were before an edit", "joints/pinned.py",
             "return bool(changed or found != before)", "return False", "jointed/test_welds.py", "may_move"),
    Mutation("equilibrium: sought where nothing can hold", "rows/equilibrium.py", "return work > most * fastest",
             "return False", "rows/test_equilibrium.py", "before_its_budget"),
    Mutation("equilibrium: sign of the residual", "rows/equilibrium.py", "PROXIMAL_STATICS * (V[i, c] - LEFT[i, c])",
             "PROXIMAL_STATICS * (V[i, c] + LEFT[i, c])", "rows/test_equilibrium.py", "guess"),
    Mutation("statics: what moves is held like what rests", "contacts/statics.py",
             "START[i, c] += V[i, c] / max(steps, 1.0)", "START[i, c] += 0.0", "islands/test_large_piles.py", "slides"),
    Mutation("rest: free spins count", "islands/rest.py", "i < A.COUNT.disks and", "i < 0 and",
             "islands/test_at_rest.py", "spins_on"),
    Mutation("ledger: factor 1/2 of friction", "rows/energy.py", "tangential = -0.5 * L[i, 1]", "tangential = -L[i, 1]",
             "rows/test_blocks.py", "coulomb"),
    Mutation("ledger: the part of an interval that was cut", "islands/shortened.py",
             "tangential = -f * pushed.tangential * (pushed.ut_before + 0.5 * f *",
             "tangential = -f * pushed.tangential * (pushed.ut_before + 0.5 *", "oracles/test_ledger.py",
             "hit_while_it_slides"),
    Mutation("slips: what turns round does not end an interval", "islands/candidates.py", "    if turned > 0.0:",
             "    if False:", "islands/test_slips.py", "incline"),
    Mutation("slips: friction's limit with the slip", "islands/candidates.py", "turned = before - after + change +",
             "turned = before - after - change +", "islands/test_slips.py", "incline"),
    Mutation("building: a contact of an interval that was cut is the other end of a face", "islands/building.py",
             "if c > 0 and before.root == LASTED and a", "if c > 0 and a", "islands/test_slips.py", "after_a_cut"),
    Mutation("shortened: what has given keeps it", "islands/shortened.py", "if not gave_energy(A, first,",
             "if gave_energy(A, first,", "islands/test_shortened.py", "flies_freely"),
    Mutation("shortened: solved for the whole interval", "islands/shortened.py", "n, s, sweeps_of(n, start), 0.0",
             "n, A.PAR.dt, sweeps_of(n, start), 0.0", "islands/test_shortened.py", "flies_freely"),
    Mutation("shortened: half of the gain is taken", "islands/shortened.py", "scale_to_lose(LOST[g] + SQUARE[g],",
             "scale_to_lose(0.5 * LOST[g] + SQUARE[g],", "islands/test_shortened.py", "scaled_impulses"),
    Mutation("laws: inactive contacts break none", "rows/columns.py",
             "worst = max(worst, ROWS[i].wake - normal_rate(ROWS[i], V))", "worst = max(worst, 0.0)",
             "rows/test_gentle.py", "inactive"),
    Mutation("gentle: what is no number is not excessive", "rows/gentle.py",
             "if not abs(L[i, 0]) + abs(L[i, 1]) <= EXCESSIVE_IMPULSE * mass * speed",
             "if abs(L[i, 0]) + abs(L[i, 1]) > EXCESSIVE_IMPULSE * mass * speed", "rows/test_gentle.py", "excessive"),
    Mutation("gentle: wedged contacts keep their friction", "rows/laws.py", "drop_friction(problem.ROWS, problem.m)",
             "problem.ROWS", "rows/test_gentle.py", "corner"),
    Mutation("ledger: sign of the work of forces", "impacts/close.py", "PAR.external += work",
             "PAR.external -= work", "oracles/test_ledger.py", "forces_on_bodies"),
    Mutation("ledger: sign of the work of a surface", "contacts/works.py", "work -= beta * (ROWS[i].surface",
             "work += beta * (ROWS[i].surface", "oracles/test_friction.py", "belt_works"),
    Mutation("rows: slip of what a turning wall carries along", "contacts/turning.py", "row.surface -= counted",
             "row.surface -= 0.0 * counted", "contacts/test_turning.py", "sticks"),
    Mutation("joints: work of what a turning wall carries along", "jointed/losses.py", "row.surface + row.swung",
             "row.surface - row.swung", "contacts/test_turning.py", "joints_connect"),
    Mutation("ledger: damping of speeds, not energies", "impacts/begin.py",
             "(1.0 / (half_damping * half_damping) - 1.0)", "(1.0 / half_damping - 1.0)",
             "oracles/test_ledger.py", "damping"),
    Mutation("joints: a groove pulls", "newton/response.py",
             "W.link[k].kind != GROOVE and not (full and W.link[k].kind < GEAR and turns_over(W, k))", "True",
             "jointed/test_taut.py", "groove"),
    Mutation("joints: what pushes a body pulls", "newton/response.py", "turns_over(W, k))", "False)",
             "jointed/test_taut.py", "pushes_a_body"),
    Mutation("joints: motors in parts of a step", "jointed/bounded_rows.py", "low = high = hinge.total[r]", "low = low",
             "jointed/test_bounded.py", "different_bounds"),
    Mutation("joints: what pulls gives way", "newton/response.py", "not (pulls or slight):", "not slight:",
             "jointed/test_taut.py", "derivative"),
    Mutation("homotopies: slip against the friction", "rows/pivots.py", "-1.0 if slides > 0.0 else 1.0",
             "1.0 if slides > 0.0 else -1.0", "rows/test_homotopy.py", "without_impulses"),
    Mutation("homotopies: a state left by the side it was entered", "rows/homotopy.py",
             "sense = 1.0 if margin(tableau, m, changed, number, 1) > 0.0 else -1.0", "sense = -1.0",
             "rows/test_homotopy.py", "without_impulses"),
    Mutation("joints: what presses is taut", "joints/step.py", "turn = -(rax", "turn = (rax",
             "jointed/test_taut.py", "pulls_hard"),
    Mutation("joints: what is wedged keeps its friction", "jointed/contact_laws.py",
             "if residual > WEDGED * S.scale and", "if False and",
             "jointed/test_impacts.py", "conveyed"),
    Mutation("joints: contacts may act as bodies accelerate", "jointed/contact_laws.py", "V) - pull * h) <= 0.0",
             "V)) <= 0.0", "jointed/test_convergence.py", "may_act"),
    Mutation("joints: what is hit often enough is busy", "impacts/resolution.py",
             "make_busy(A, root)", "pass", "jointed/test_impacts.py", "lands_on_all"),
    Mutation("joints: contacts close as velocities fit", "jointed/fitting.py", "if fastest > FIT_CLOSING * scale:",
             "if fastest > 1e300 * scale:", "jointed/test_taut.py", "0.0001-1e-06-5.0"),
    Mutation("ledger: sign of the work of a support", "joints/ledger.py", "ledger.supports -= work",
             "ledger.supports += work", "joints/test_frame.py", "paid_for_by_nothing_else"),
    Mutation("ledger: work of supports by the balance of momentum", "joints/frame.py",
             "frame_work += impulse * speed", "frame_work -= impulse * speed", "joints/test_frame.py",
             "by_impulses"),
    Mutation("ledger: supports without a frame give nothing", "joints/ledger.py",
             "change if move_apart(W) else part.frame_work", "part.frame_work", "joints/test_frame.py",
             "tear_joints"),
    Mutation("joints: speeds of what supports lead stay off", "joints/gains.py", "if fit_led(W):", "if False:",
             "joints/test_frame.py", "no_more_energy and 0.0333 and 1.01-0.001"),
    Mutation("ledger: what turns has no frame", "joints/frame.py", "rigid, hangs, turns = W.J.LOCAL, True,",
             "rigid, hangs, turns = W.J.LOCAL, not has_prescribed_motion(W),", "joints/test_frame.py",
             "gives_joints_no_more and 96"),
    Mutation("ledger: supports at impacts", "impacts/joint_impact.py",
             "A.PAR.external += gained_energy(", "A.PAR.external += 0.0 * gained_energy(", "jointed/test_supports.py",
             "struck"),
    Mutation("ledger: errors of answers at impacts", "impacts/joint_impact.py",
             "FREE[q, c] + s * (", "FREE[q, c] + (", "impacts/test_joint_impact.py", "response"),
    Mutation("ledger: what a limit costs that moves", "joints/correct.py",
             "lost = kinetic_of(W, CHANGE)", "lost = 2.0 * kinetic_of(W, CHANGE)",
             "jointed/test_supports.py", "stopped"),
    Mutation("intervals: the closing of linear rows is real", "islands/depths.py",
             "last, deep = pair, min(deep, known)", "last = pair", "islands/test_depths.py", "poses"),
    Mutation("initial penetration: bodies that fly on stay in others", "islands/building.py",
             "if -u <= A.PAR.pulled * dt:", "if -u < 0.0:", "islands/test_penetration.py", "fly_on"),
    Mutation("sorting: the other way", "rows/inplace.py", "A[j - gap] > value", "A[j - gap] < value",
             "rows/test_inplace.py", "sorted"),
    Mutation("lock: no scale", "rows/energy.py", "s = large / q", "s = 1.0", "rows/test_blocks.py", "debt"),
    Mutation("lock: factor 1/2 of the paper's closures", "energy/balance.py",
             "0.5 * np.bincount(island, lam * (A @ lam)", "np.bincount(island, lam * (A @ lam)",
             "energy/test_equations.py", "lock"),
    Mutation("paper: psi1 + psi2 = 2 xi / Omega", "energy/balance.py", "return 4.0 * damping_ratio / reduced_frequency",
             "return 2.0 * damping_ratio / reduced_frequency", "energy/test_equations.py", "signorini_closed"),
    # One place each: sides, manifolds, lists, the lock, the correction, rest, the driver, rows over an operator.
    Mutation("corners: those that come near while the nearest closes do not count", "prediction/axes.py",
             "return bottom - reach, top + reach", "return bottom, top",
             "prediction/test_many_corners.py", "left_out"),
    Mutation("cycles: rows count as dependent", "joints/step.py",
             "return not independent", "return True",
             "joints/test_redundancy.py", "which_rows"),
    Mutation("sides: a remembered normal is not used", "geometry/sides.py",
             "if near.distance > reach or near.nx * mx + near.ny * my >= 0.0:", "if True:",
             "islands/test_large_steps.py", "rod"),
    Mutation("corners: the side that looks out of them", "geometry/sides.py", "lx, ly = -sign * uy, sign * ux",
             "lx, ly = sign * uy, -sign * ux", "islands/test_corners.py", "inner_side"),
    Mutation("manifold: rows stay as seen from the other shape", "geometry/manifold.py",
             "    reverse(OUT, count)\n    return count\n\n\n@nonallocating\ndef support",
             "    return count\n\n\n@nonallocating\ndef support",
             "geometry/test_manifold.py", "exchange_and_reflection"),
    Mutation("lists: a pair is flagged in one list alone", "pairs/rules.py", "for s, o in ((a, b), (b, a)):",
             "for s, o in ((a, b), (a, b)):", "pairs/test_lists.py", "flags_follow"),
    Mutation("lists: what leaves stays in the lists of others", "pairs/grid.py", "            remove(A, o, s)",
             "            pass", "pairs/test_lists.py", "one_by_one and disks"),
    Mutation("lists: a wall is found in its first cell alone", "pairs/walls.py",
             "if max(west, first_column) == column and", "if first_column == column and",
             "pairs/test_lists.py", "looking_at_all"),
    Mutation("lock: the root that is farther from 1", "rows/energy.py", "if abs(other - 1.0) < abs(s - 1.0) else",
             "if abs(other - 1.0) > abs(s - 1.0) else", "rows/test_blocks.py", "debt"),
    Mutation("lock: velocities keep their scale", "rows/energy.py",
             "        velocities(problem, L, FREE, V)\n    return s",
             "        pass\n    return s", "rows/test_blocks.py", "debt"),
    Mutation("correction: the common turn is the other way", "contacts/correction.py", "return -gained / inertia",
             "return gained / inertia", "contacts/test_piles.py", "free_island"),
    Mutation("correction: turns move no point", "contacts/correction.py", " + abs(D[i, 2]) * EXTENT[i])", ")",
             "islands/test_penetration.py", "no_point"),
    Mutation("arbiters: those of sleeping bodies keep no impulses", "space/sleep_groups.py",
             "keep_sleeping(first.space, group)", "pass", "space/test_arbiters.py", "of_sleeping_bodies"),
    Mutation("correction: walls have no last word", "rows/lifting.py",
             "met = meet_gap(problem, GAPS[i] - LEAST[i], MU, D, i) == 0.0 and met", "pass",
             "rows/test_lifting.py", "without_room"),
    Mutation("rest: what rested beside others stays so as they move", "islands/partial_rest.py", "set_awake(A, other)",
             "pass", "islands/test_at_rest.py", "awake_again"),
    Mutation("intervals: past a corner is through", "islands/depths.py",
             "after = max(told, min(gap, 0.0) - known_depth(A, a, b))", "after = min(gap, 0.0) - known_depth(A, a, b)",
             "islands/test_depths.py", "corner_of_a_triangle"),
    Mutation("intervals: what is deep may close as far as what touches", "islands/depths.py",
             "if not held and width > 0.0 and", "if False and", "islands/test_depths.py", "near_the_middle"),
    Mutation("jointed: arms that do not converge change angular momentum", "jointed/correction.py",
             "EXCESS[GROUP[ROWS[i].a]] += along * L[i, 1] + across * L[i, 0]", "pass", "jointed/test_momentum.py",
             "taken_back"),
    Mutation("joints: closing changes angular momentum", "joints/closing.py",
             "cost += restore_momenta(W, 0.0, False) if own else 0.0", "cost += 0.0", "jointed/test_momentum.py",
             "as_they_close and 46"),
    Mutation("joints: linear rows pass limits", "joints/gains.py", " or passes_limits(W)", "",
             "joints/test_contradiction.py", "have_passed_a_limit"),
    Mutation("correction: none within a step", "islands/depths.py", "return 0.5 * intervals.CORRECTION_STEP",
             "return math.inf", "contacts/test_turning.py", "drum and True and 1.6"),
    Mutation("rest: what moves ends only its own contacts", "islands/accounting.py",
             "    set_awake(A, root)\n    close_interval(A, root, t)\n", "",
             "islands/test_support.py", "wakes_its_support"),
    Mutation("correction: impacts do not pay for one body", "islands/payment.py", "n == 1 or", "",
             "islands/test_large_steps.py", "inside_the_floor and 14-3.0"),
    Mutation("correction: impacts do not pay in free islands", "islands/payment.py", "len(isle.WHO) == n or", "",
             "contacts/test_turning.py", "drum and False and 0.1"),
    Mutation("correction: impacts do not pay for what is deep", "islands/payment.py", " or deep\n", "\n",
             "islands/test_large_steps.py", "on_one_another and 1.0"),
    Mutation("joints: islands of the last one go on", "joints/workspace.py", "if MEMBER[i].tied >= 0 and s < 0:",
             "if False:", "jointed/test_ledger.py", "last_joint_was_removed"),
    Mutation("joints: bodies that are let go keep no mobility", "impacts/scene.py",
             "        self.release()\n        if replan", "        if replan", "jointed/test_welds.py", "may_move"),
    Mutation("correction: sign of its work", "contacts/correction.py", "= -work_of_forces(", "= work_of_forces(",
             "contacts/test_piles.py", "push_out"),
    Mutation("rest: forces keep half of the length of the step", "islands/at_rest.py",
             "longer = A.PAR.dt / pushed.length", "longer = 0.5", "islands/test_at_rest.py", "bear_its_weight"),
    Mutation("rest: a carrier that begins to move wakes nothing", "islands/at_rest.py",
             "(ruled or moves_itself(A, A.LINK[a].owner) or moves_itself(A, A.LINK[b].owner))", "ruled",
             "islands/test_at_rest.py", "wakes"),
    Mutation("edits: added and removed bodies are not counted", "space/edits.py", "name in private.CONTENTS",
             "name in private.CONTENTS[::2]", "space/test_private.py", "watch_sees"),
    Mutation("shapes: late ones stay where they were", "space/late_shapes.py", "    if known.late:\n",
             "    if False:\n", "space/test_late_shapes.py", "whatever_reads"),
    Mutation("partners: their centre of gravity is turned backwards", "joints/partners.py",
             "known[1] + s * FIXED[i, 0]", "known[1] - s * FIXED[i, 0]", "space/test_joints.py", "centre_of_gravity"),
    Mutation("partners: one that moves marks no joint", "joints/partners.py", "JOINT[j].touched = EDITED",
             "JOINT[j].touched = JOINT[j].touched", "space/test_joints.py", "partners_that_move_are"),
    Mutation("driver: sweeps alone", "contacts/relaxation.py", "if rounds == 0 or STATE.wait > 0.0:", "if True:",
             "contacts/test_piles.py", "stack_stands_still"),
    Mutation("operator: tangents answer as normals do", "rows/dense.py", "C.T[w, k] if kind[j] == 1 else",
             "C.N[w, k] if kind[j] == 1 else", "rows/test_columns.py", "sweeps_and_matrices"),
    # Joints and contacts whose solutions are not unique, and joints that contradict one another.
    Mutation("jointed: laws are solved exactly though impulses are excessive", "jointed/contact_laws.py",
             "rough = first and manner.exactly and excessive(", "rough = False and excessive(",
             "jointed/test_budget.py", "solved_at_once and 1.0-1.0-True"),
    Mutation("jointed: factors of other intervals are kept", "jointed/gathered.py",
             "J.PROGRESS.kept = 0, UNTESTED, 0", "J.PROGRESS.kept = 0, UNTESTED, J.PROGRESS.kept",
             "jointed/test_factors.py", "earlier_interval"),
    Mutation("jointed: no factors are kept", "joints/step.py", "W.J.PROGRESS.kept == W.s + 1 and", "False and",
             "jointed/test_factors.py", "share"),
    Mutation("jointed: what motors accelerate is near rest", "jointed/contact_laws.py",
             "S.slow < joints.NEAR_REST * change", "S.slow < change", "jointed/test_factors.py", "near_rest"),
    Mutation("newton: rows that act otherwise keep their factors", "newton/entries.py",
             "if not build and W.J.HINGE[k].weight[r] != weight:", "if False:", "jointed/test_factors.py",
             "limit_that_acts"),
    Mutation("lengths: intervals grow by half", "jointed/lengths.py",
             "max(INTERVAL_RETRY, 1.0 / max(far, 1.0 / INTERVAL_GROWTH))", "INTERVAL_RETRY",
             "jointed/test_lengths.py", "grow"),
    Mutation("homotopy: discs are left to sweeps", "rows/homotopy_start.py",
             "(discs or row.part == SINGLE) and", "row.part == SINGLE and",
             "rows/test_homotopy.py", "bounded_pivots"),
    Mutation("joints: an error that has stalled is no round-off", "newton/solve.py",
             "NEWTON_FLOOR if stalls > 1 else", "JOINT_ROUND_OFF if stalls > 1 else",
             "joints/test_redundant.py", "knots"),
    Mutation("joints: round-off is an error to be solved", "newton/solve.py", "(sure and worst < JOINT_ROUND_OFF and",
             "(False and worst < JOINT_ROUND_OFF and", "newton/test_equations.py", "stiff_springs"),
    Mutation("correction: bodies without shapes are the smallest", "contacts/correction.py",
             "EXTENT[i] if EXTENT[i] > 0.0 else math.inf", "EXTENT[i]", "jointed/test_correction.py", "without_shapes"),
    Mutation("joints: momenta are off by the round-off of large impulses", "joints/gains.py",
             "part.closed += restore_momenta(W, h, False)", "pass", "joints/test_pairs.py",
             "[431]"),
    Mutation("joints: round-off of loads is a gain", "joints/gains.py",
             "kinetic_of(W, NOW) + load_of(W, h, length))", "kinetic_of(W, NOW))", "joints/test_limits.py",
             "cannot_pay"),
    Mutation("blocks: wedged contacts keep their friction", "rows/blocks.py", "drop_friction(ROWS, m)", "pass",
             "rows/test_blocks.py", "wedges"),
    Mutation("blocks: of wedged contacts only the second solve counts", "rows/blocks.py", "OUT[0].sweeps += sweeps",
             "pass", "rows/test_blocks.py", "wedges"),
    Mutation("joints: momenta are off by the round-off of a projection", "joints/correct.py",
             "restore_momenta(W, 0.0, True)", "pass", "joints/test_pairs.py", "[834]"),
    Mutation("joints: pivots that stay apart act at two points", "newton/rows.py",
             "if joint.kind != PIVOT or what == POSES or joint.touched == 0:", "if True:", "joints/test_apart.py",
             "stays_apart and 60 or impact"),
    Mutation("joints: a gain that nothing pays is kept", "joints/gains.py",
             "fails = gain_unpaid(W, h, length, own)", "fails = False", "joints/test_pairs.py", "[803]"),
    Mutation("joints: gears of any ratio keep angular momentum", "joints/frame.py",
             "W.link[k].kind == GEAR and W.J.JOINT[W.link[k].joint].ratio != 1.0", "False",
             "joints/test_kinds.py", "free_wheels"),
    Mutation("sides: geometry tells the side of what is flush", "prediction/sides.py",
             "d <= most and flush(P, p, Q, q, nx, ny, most)", "False", "impacts/test_flush.py",
             "stays_on_it and step_by_another and size0"),
    Mutation("sides: other shapes of the body tell none", "prediction/sides.py", "if abs(along) > SAME_SIDE and",
             "if False and", "impacts/test_flush.py", "leaves_it and add_flush and size0"),
    Mutation("sides: additions forget them", "impacts/taking_over.py", "keep_sides(A, P.SIDE, OUTLINES)", "pass",
             "impacts/test_flush.py", "leaves_it and add_far and size0"),
)  # fmt: skip


def passes(copy: Path, tests: list[tuple[str, str]]) -> tuple[bool, str]:
    """Whether all these tests pass in the copy; what pytest says last."""
    said = ""
    for file, only in tests:
        try:
            done = subprocess.run(
                [sys.executable, "-m", "pytest", "-x", "-n0", "-p", "no:cacheprovider", f"tests/{file}", "-k", only],
                cwd=copy, env=os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONDONTWRITEBYTECODE": "1"},
                capture_output=True, text=True, timeout=LIMIT,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return False, f"it does not end within {LIMIT} s"
        said = (done.stdout.strip().splitlines() or [""])[-1]
        if done.returncode == 1:
            return False, said
        if done.returncode != 0:  # no test of that name, say
            raise SystemExit(f"{file} -k {only!r}: {done.stdout}{done.stderr}")
    return True, said


def tried(copy: Path, one: Mutation) -> str:
    """What came of a mutation; its first word is "noticed", "SURVIVES" or "UNFIT"."""
    path = copy / "eeca_pymunk" / one.file
    text = path.read_text()
    if text.count(one.old) != 1:
        return f"UNFIT: {one.old!r} stands {text.count(one.old)} times in {one.file}"
    try:
        path.write_text(text.replace(one.old, one.new))
        passed, said = passes(copy, [(one.test, one.only)])
    finally:
        path.write_text(text)
    return f"SURVIVES tests/{one.test} -k {one.only!r}" if passed else f"noticed by tests/{one.test}: {said}"


def main(words: list[str]) -> int:
    """Try the mutations whose names have all these words; how many were not noticed."""
    chosen = [one for one in MUTATIONS if all(word in one.name for word in words)]
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)
        for name in COPIED:
            if (ROOT / name).is_dir():
                shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__", "figures"))
            else:
                shutil.copy(ROOT / name, copy / name)
        whole, said = passes(copy, list(dict.fromkeys((one.test, one.only) for one in chosen)))
        if not whole:
            raise SystemExit(f"a test fails without any mutation: {said}")
        print("all named tests pass without mutations", flush=True)
        missed = 0
        for number, one in enumerate(chosen, 1):
            found = tried(copy, one)
            missed += not found.startswith("noticed")
            print(f"{number:2}/{len(chosen)} {one.name}: {found}", flush=True)
    print(f"{len(chosen) - missed} of {len(chosen)} mutations noticed")
    return missed


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
