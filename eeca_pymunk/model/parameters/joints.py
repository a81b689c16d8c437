"""Joints: residuals and budgets of their solution, alone and with contacts."""

from __future__ import annotations

from .record import accuracy, heuristic, round_off, work

# fmt: off
JOINT_TOUCH = round_off(1e-12, "of the component", "Gap of a limit below which it is reached.")
BOUNDED_SOLVES = work(6, "solves", "Linear systems of a step whose bounded impulses come to their bounds, at most.")
MOST_BOUNDED = work(64, "bounded rows", "Number above which bounded rows are not solved together with contacts.")
BOX_SECULAR = work(40, "iterations", "Iterations for the multiplier of a friction disc.")
CONDENSED_PASSES = work(3, "number",
    "Passes of a condensed solution of rows that may be redundant, or that no iteration follows; else one.")
REFINEMENT_WORK = work(400.0, "operations", "Work of each of them for the rows of a joint.")
STIFFEST = round_off(10000000.0, "of the bodies' inertia", "Stiffness of rows in a condensed system, at most.")
JOINT_SPEED_ROUND_OFF = round_off(1e-14, "of the speeds", "Velocity along a joint row that is round-off.")
JOINT_SPEED_LEFT = heuristic(0.01, "of the speeds along a row",
    "Velocity along a joint row up to which it is an error of steps and not an edit to be corrected.")
TAKEN_OVER_LEFT = heuristic(0.05, "of the kinetic energy of the component",
    "Energy of velocities along joint rows up to which, where no earlier step is known, it is an error of the steps of "
    "another stepper and not given by the program; or, where supports that move apart lead bodies, left as it is.")
LEAST_INERTIA = work(0.1, "of a body's inertia",
    "Inertia that the geometric stiffness of joints may leave in the smaller one of two systems, whose solution is "
    "the same; below it the larger one is solved.")
IMPACT_LIMITS = work(4, "solutions",
    "Solutions of an impact, or of a correction of overlaps, each with the limits that the one before moves into.")
IMPACT_ENERGY = round_off(4e-16, "of the kinetic energy", "Change of energy by an impact that is round-off.")
LIMIT_EVENTS = work(12, "number", "Limits that are reached in one step of a component, at most.")
LIMIT_WAY = round_off(1e-9, "of the component", "Way of a limit to its bound up to which the part before it is empty.")
LIMIT_HOP = heuristic(1e-6, "of the component",
    "Way by which a limit may leave its bound and return in a part of a step, and be held.")
LIMIT_SECANTS = work(30, "iterations", "Secant steps to the instant at which a limit is reached, at most.")
LIMIT_SECANTS_HASTE = work(2, "iterations", "Secant steps to that instant after the work HASTE.")
LIMIT_SOLVES = work(8, "number", "Linear solves that release limits which pull, at most.")
LIMIT_SEARCHES = work(100, "number",
    "Solves of a part between limits, beside two for each joint, after which limits are no longer searched but land.")
LOCK_ITERATIONS = work(8, "iterations", "Fixed-point iterations of the mean arms in the energy lock.")
CONDENSE_BAND = work(14, "half-width of the band",
    "Half-width above which the system of a component is condensed to its bodies.")
RESPONSE_PASSES = work(2, "number", "Refinements of the response of a component.")
JOINT_TOLERANCE = round_off(3e-16, "of the component", "Error of joints and momenta at which Newton iterations end.")
JOINT_ROUND_OFF = round_off(3e-14, "of the component", "An error below it that no longer halves is round-off.")
JOINT_ROUND_OFF_KEPT = round_off(2e-15, "of the component",
    "The same, where factors are used in several iterations.")
NEWTON_PROGRESS = work(0.03, "ratio of errors",
    "Progress of an iteration with earlier factors below which they are computed again; it ends at JOINT_TOLERANCE "
    "with either.")
NEWTON_FLOOR = round_off(1e-11, "of the component", "Error below which one that twice has not halved is round-off.")
ELASTIC_ROUND_OFF = round_off(1e-12, "of the component",
    "Error by round-off of the impulses of elastic joints above which these have to be softer.")
SPACING = round_off(2.2e-16, "of a number", "Spacing of floating-point numbers.")
NEWTON_ITERATIONS = work(25, "iterations", "Newton iterations of a step, at most.")
ROW_APART = work(0.01, "of the square of a row",
    "Part of a joint's row outside the span of others below which rows count as redundant: impulses begin anew.")
REDUNDANT_EPSILON = round_off(1e-10, "of the diagonal", "Term added to the diagonal for rows that may be redundant.")
REDUNDANT_MOST = work(0.01, "of the diagonal",
    "The same while errors are large, at most: rows that contradict each other have small impulses. Where that is "
    "slow, as with a load on bodies thousands of times lighter, a step is tried again with REDUNDANT_EPSILON.")
CLOSING_EPSILON = round_off(1e-05, "of the diagonal", "Term added to the diagonal while joints that are apart close.")
CLOSINGS = work(8, "iterations", "Iterations to close joints that are apart, at most.")
REDUNDANT_PASSES = work(12, "number", "Passes of a projection of velocities, at most, beside three for each joint.")
FACTOR_BAND = work(16, "rows",
    "Half-width of the band from which on factors and solutions take rows as views, several numbers at a time.")
ROW_WORK = work(430.0, "operations", "Work of the rows of a joint in an iteration, for the budget of a step.")
FACTOR_WORK = work(210.0, "operations", "Work of the factors of a row besides that of its band.")
BACK_WORK = work(4.0, "operations", "Work of a solution for each row and each number in its band.")
JOINT_APART = accuracy(1e-10, "of the component", "Error of a joint above which it closes at pymunk's rate.")
ELASTIC_PARTS = work(7, "number", "Parts of a step of elastic joints.")
HASTE = work(0.25, "of the budget of a step", "Work of joints after which limits land, and are located roughly.")
COMPONENT_BUDGET = work(0.5, "of what is left", "Work of one step of a component, at most.")
BALANCED = round_off(1e-6, "of the errors of joints, as forces",
    "Force on bodies by which the errors of joints balance: these contradict one another, and become elastic at once.")
NEARLY_HELD = accuracy(1e-08, "of the component, or rad",
    "Error of elastic joints, by their own formulas, up to which the step counts as converged.")
GIVEN_INTERVAL = work(1e-6, "of the step",
    "Length of an interval below which joints that give way are not tried for a shorter one.")
REPAID = accuracy(1e-3, "of the kinetic energy",
    "Gain of closing joints that an earlier step left apart, up to which it is locked.")
JOINT_GAIN = round_off(1e-12, "of the kinetic energy before and after",
    "Gain of joints that hold in a step, above which it is taken from what moves.")
MOMENTUM_LEFT = round_off(1e-14, "of the sum of the magnitudes of momenta",
    "Error of the momenta of a component, above which they are restored at the end of each part of a step.")
GAIN_KEPT = round_off(1e-10, "of the kinetic energy, and of the work of forces over the size",
    "Gain of joints that hold which the relative motion of bodies is too little to pay: with more they move as one.")
STALLED = accuracy(100.0, "of all momenta, loads and forces of a component, as angular momentum",
    "Impulse that a motor of unlimited force may have in a step: what drives against a limit stalls.")
TAUT = heuristic(0.5, "of a body's inertia",
    "Stiffness of a joint's force, times h^2/4: from which redundant joints begin with their last impulses, as these "
    "hold bodies; and, of joints that press, up to which contacts take it into account, as beyond twice that no "
    "inertia of the body would be left. A box stays on a tight bridge.")
ARM_ITERATIONS = work(30, "iterations",
    "Most iterations of the motion in which arms of contacts become those of its middle (`advance_aligned`).")
ARM_ERROR = round_off(1e-15, "of the component", "Error of the arms of contacts at which these iterations end.")
ARM_LEFT = round_off(1e-12, "of the component",
    "Error of the arms of contacts that is left by these iterations, above which contacts are not solved: angular "
    "momentum changes by as much of what they exchange.")
MOTOR_OFF = round_off(1e-9, "of the speed, and of its bound",
    "Speed of a bounded row off its target, inside its bounds, that is an error.")
BOUNDED_SWEEPS = work(30, "sweeps", "Sweeps over bounded joint rows and contacts.")
STRAIGHT_CHAIN = round_off(1e-12, "of length and coordinates",
    "Slack of a chain of joints between fixed points up to which it cannot move.")
STRUT = round_off(1e-6, "of the free mobility",
    "Mobility of a contact between two bodies of one component that is the error of its response where joints are "
    "redundant: the contact is left out.")
STRUT_BETWEEN = round_off(1e-07, "of the free mobility",
    "Mobility of other contacts that is the error of the response.")
CORRECTION_JOINTS = accuracy(1e-11, "of the component", "Error of joints when overlaps are corrected.")
PROJECTED_CLOSING = round_off(1e-09, "of the island's speed",
    "Speed with which contacts may close after velocities were projected onto the joints.")
PROJECTED_RESIDUAL = accuracy(1e-06, "of the fastest closing contact",
    "Residual of the impulses that keep contacts from closing in this projection.")
PROJECTED_ENERGY = round_off(1e-12, "of the energy", "Change of energy by this projection that is round-off.")
JOINTED_CORRECTION_SWEEPS = work(40, "sweeps", "Sweeps of the penetration correction of jointed bodies.")
JOINTED_LIFT_ERROR = accuracy(0.001, "of the deepest overlap", "Error of this correction, also of limits in its way.")
JOINTED_CORRECTION_TRIES = work(4, "number", "How often it is tried within its budget, at most.")
JOINTED_CORRECTION_LESS = work(0.25, "of the displacements", "Part of the last try that the next one takes.")
STEP_WORK = work(32000000.0, "operations",
    "Work of a step with joints besides STEP_WORK_BODY; 2.5e9 operations take about a second.")
INTERVAL_SHARE = work(0.25, "of what is left of the budget",
    "Work of a long interval after which it is solved again, shorter, if it has not converged: this, or the island's "
    "part of all bodies, if that is more.")
STEP_WORK_BODY = work(130000.0, "operations",
    "Work of a step with joints for each body of the scene; a third as much for those of its largest component.")
CUT_WORK = work(8000000.0, "operations",
    "Work for the intervals with joints that end where a step is cut short, beside its budget.")
COMPONENT_WORK = work(1100.0, "operations", "Work of a step of a component, beside its iterations.")
COMPONENT_WORK_BODY = work(650.0, "operations", "What each of its bodies adds to it.")
MEET = round_off(1e-13, "of the smaller shape", "Gap at the located instant of an impact on a component.")
MEET_LOADED = accuracy(1e-06, "of the smaller shape", "Gap at that instant if contacts push on the component.")
MEET_MANY = accuracy(0.0001, "of the smaller shape", "Gap at that instant if many contacts push on it.")
MEET_DEEP = accuracy(0.0001, "of the smaller shape",
    "Depth at that instant, or more of it than at the start of the interval, from which on it is searched further.")
MEET_DOUBLINGS = work(20, "number", "Impacts up to which an interval in which joints only begin to act doubles.")
MEET_SECANTS = work(5, "iterations", "Secant steps to the instant of an impact on a component, at most.")
MEET_HALVINGS = work(40, "iterations", "Halvings of the time to an instant before shapes pass each other, at most.")
MEET_SECANTS_LOADED = work(2, "iterations", "Secant steps to that instant if contacts push on the component.")
END_HALVINGS = work(5, "iterations",
    "Halvings of an interval that ends before an impact, until it may; then to nothing.")
MEET_INSTANT = round_off(1e-9, "of the step",
    "Length below which an interval before an impact, or a part before a limit, is empty.")
PART_ROUND_OFF = round_off(1e-13, "of the step", "Length of a part of a step that is not solved.")
COLUMN_CONTACTS = work(40, "contacts",
    "Number up to which islands are solved by homotopies, with joints always: exactly; others roughly. With joints, "
    "those count that may act.")
COLUMN_SWEEPS = work(3, "sweeps", "Sweeps over components before the first homotopy.")
COLUMN_SWEEPS_AFTER = work(4, "sweeps", "Sweeps over components after each homotopy, at most.")
COLUMN_HOMOTOPIES = work(8, "homotopies", "Homotopies to the solution, at most.")
COLUMN_REPEATED = work(0.1, "of the residual",
    "Difference of the residuals of two homotopies up to which they end in the same state: there are no more.")
COLUMN_DIVERGES = work(2.0, "ratio of residuals",
    "Growth of the residual by the last sweeps from which on what was before them is kept.")
COLUMN_PROXIMAL = round_off(10000000000.0, "over the effective mass",
    "Stiffness of the proximal term of redundant contacts of components.")
OUTER = work(20, "steps of the components", "Iterations between contacts and components, at most.")
OUTER_MANY = work(2, "steps of the components", "These iterations with more than COLUMN_CONTACTS contacts.")
OUTER_PART = work(1, "steps of the components",
    "These iterations in an interval of many contacts that ends within the step.")
AGREE = accuracy(1e-06, "of |a| h and the speed",
    "Difference of the velocities of contacts and components at which their iterations end; at which contacts count as "
    "solved if it does not fall.")
LOCK_SHIFT = accuracy(1e-05, "of |a| h and the speed",
    "Change of velocities by which the energy lock may break the laws of contacts.")
AGREE_REST = accuracy(1e-11, "of |a| h and the speed", "This difference near rest.")
NEAR_REST = accuracy(0.1, "of |a| h, with springs and motors", "Mean speed of an island below which it is near rest.")
AGREE_ELASTIC = accuracy(1e-13, "of |a| h and the speed", "This difference in elastic islands.")
LAWS_SWEEPS_FEW = work(30, "sweeps", "Sweeps over few contacts of components.")
LAWS_SWEEPS_ELASTIC = work(400, "sweeps", "Sweeps over elastic contacts of components.")
LAWS_RESIDUAL = accuracy(1e-09, "of |a| h and the speed", "Residual of sweeps over contacts of components.")
LAWS_RESIDUAL_REST = accuracy(1e-12, "of |a| h and the speed", "Residual of these sweeps near rest.")
LOCK_TRIES = work(10, "number", "Attempts of the energy lock of components, at most.")
JOINTS_NEAR = accuracy(1e-09, "of the component", "Error of joints while many contacts have not converged.")
UPDATE_ROUND_OFF = round_off(1e-12, "of the size of a body",
    "Way in an interval up to which columns are not updated by what they missed.")
OUTER_FLOOR = round_off(1e-08, "of the speed",
    "Difference of the velocities at which elastic contacts count as solved if it does not fall: round-off of stiff "
    "components.")
LOSS_ROUND_OFF = round_off(4e-14, "of impulses times speed", "Round-off of the work of contacts of components.")
SWEEP_WORK = work(38.0, "operations", "Work of a sweep for each contact and bounded row.")
SWEEP_ENTRY_WORK = work(15.0, "operations", "Work of a sweep for each entry of their columns.")
SLIP_WORK = work(125.0, "operations", "Work of a contact in a sweep beside that if it does not stick.")
DISC_WORK = work(700.0, "operations", "Work of a sweep over bounded rows for each two of a disc.")
HOMOTOPY_WORK = work(6000.0, "operations", "Work of a homotopy besides that of its matrix.")
MATRIX_WORK = work(12.0, "operations",
    "Work of the matrix of a homotopy, or of a direct solution, for each of its entries.")
CHANGE_WORK = work(56.0, "operations", "Work of a change of state in a homotopy for each unknown.")
CHANGE_ENTRY_WORK = work(0.6, "operations", "Work of a change of state for each entry of the matrix.")
CONTACT_WORK = work(1300.0, "operations",
    "Work of a contact in an iteration between contacts and components, besides sweeps and homotopies.")
INTERVAL_WORK = work(6600.0, "operations", "Work of an interval of an island with joints for each pair of shapes.")
LOSS_ROUND_OFF_TAUT = round_off(1e-09, "of impulses times speed",
    "Round-off of the work of contacts on taut joints, at most.")
CHORD = work(5, "steps of the components", "Iterations after which the response is computed anew.")
CLOSES = round_off(1e-12, "of the fastest contact",
    "Speed with which contacts may close after an elastic impact on components.")

LEAST_SOLUTIONS = work(10, "solutions", "Newton iterations that a step of a component may take whatever work is left.")
LINEAR_APART = accuracy(1e-4, "of the component",
    "How far one linear system may leave joints: what would be farther moves as one body. An interval that ends at "
    "an impact is shorter where elastic joints would give way farther.")
EXCESSIVE_IMPULSE = round_off(1e3, "of the island's mass and speed",
    "Impulse beyond which a solution is replaced by sweeps from zero.")
LAWS_ROUGH = work(1e-3, "of the change of velocities in a sweep",
    "Error that sweeps may leave in the first iteration if its exact impulses are excessive.")
GUESS_SPEED = round_off(1e2, "of the island's speed and |a| h",
    "Velocity without impulses, by the answers to a guess, from which on the guess is none.")
GENTLE_SWEEPS = work(20, "sweeps", "Sweeps that replace an excessive solution.")
LAWS_SOLVED = accuracy(10.0, "of AGREE",
    "Residual of the contacts' laws, solved with columns, up to which contacts count as solved.")
OUTER_STANDS = accuracy(0.001, "of AGREE, or AGREE_REST",
    "Change of velocities by a solution of the contacts' laws up to which the motion before it is their solution.")
OUTER_PROGRESS = work(0.3, "ratio of differences",
    "Progress of the iterations between contacts and components below which they are given up; they end at AGREE.")
