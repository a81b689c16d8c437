"""The scratch arrays of one island: what their columns mean.

LOCAL (n, 60) float and NODE (n, 3) int: one row per body of the island, those that joints cannot move included.
HINGE (m, 84) float and LINK (m, 11) int: one row per joint. Row vectors have six entries: 0-2 are for body a, 3-5 for
body b, along x, along y, about the centre of mass. STIFF (6, 6) is that of one joint.

Over a step h the bodies take the way h v_m = h (v0 + v1)/2 and turn by 2 atan(chi/2), chi = h w_m (Cayley), for then
r1 - r0 = chi z x r_m with r_m = (r0 + r1)/2 exactly, and energy and angular momentum are kept both. A body that no
joint holds off its centre of mass, and one that cannot be turned, turns by chi; its levers are tan(chi/2)/(chi/2) r_m.
"""

# LOCAL
POSE = 0  # 0-2: x, y, angle of the centre of mass at the start
BEFORE = 3  # 3-5: velocity and spin at the start
AFTER = 6  # 6-8: at the end; the unknowns
FREE = 9  # 9-11: acceleration without joints
MOBILITY = 12  # 12-14: 1/mass, 1/mass, 1/moment; 0 where joints cannot move
CAYLEY = 15  # 1 if the body turns by 2 atan(chi/2)
COS, SIN = 16, 17  # of the angle at the start
WAY = 18  # 18-20: h v_m; the last is chi
TURNED = 21  # angle turned
TURN_COS, TURN_SIN = 22, 23  # of that
SLOPE = 24  # its derivative by chi
LEVER = 25  # levers over r_m
PER, BEND = 26, 27  # turned/chi, its derivative by chi
GOT = 28  # 28-30: impulse of the joints
KEPT = 31  # 31-33: velocities to come back to
SAVED = 34  # 34-39: pose and velocity at the start of the whole step
ROOT = 40  # 40-42: square roots of the mobilities
SHIFT = 43  # 43-45: how far closing of joints moved it at the start
TRAVEL = 46  # 46-48: SHIFT and the sum of WAY over all parts of the step
LEAD = 49  # 49-51: acceleration by joints that Newton's method begins with
INERTIA = 52  # 52-54: diagonal of the bodies' part of a dual system, scaled; with its factors, the reciprocal
UNROOT = 55  # 55-57: reciprocals of ROOT, 0 where that is
MEAN = 58  # 58, 59: integral of x, y over the time of the parts of the step: where a constant force acts is that over h
LOCAL_COLUMNS = 60

# NODE
COLUMN, FREEDOMS = 0, 1  # first unknown of the body, number of its unknowns: 0, 2 (joints do not turn it) or 3
FIRST = 2  # 2 (a joint with impulses on it) + (which end), -1 for none
NODE_COLUMNS = 3

# HINGE
ARM_A, ARM_B = 0, 2  # 0-1, 2-3: arms at the start; of joints of angles: 0, 2 are the angles at the start
APART = 4  # 4-5: d = anchor b - anchor a at the start; of a groove: anchor b - centre a
NORMAL = 6  # 6-7: of a groove, at the start
DRAG = 8  # damping that makes the midpoint rule as exact as exp(-c K h)
BEGAN = 9  # of springs: length, or angle_a - angle_b, at the start
LAM = 10  # 10-11: impulse along the rows, of springs their own
TARGET = 12  # 12-13: what the functions g shall be at the end; of soft joints: the speed
SCALE = 14  # 14-15: 1/sqrt of the diagonal of G M^-1 G^T
BOUND = 16  # max_force of a soft joint
ENDED = 17  # of springs: length, or angle, at the end
SIZE = 18  # unit of g: length of the island, or 1 for angles
MEASURE = 19  # what limits bound, at the end: length, angle, place along a groove
TOTAL = 20  # 20-21: impulse over all parts of the step
PUSHED = 22  # 22-23: impulse of a correction
VALUE = 24  # 24-25: g at the end of the present iterate
FORCE = 26  # 26-31: J^T lam
ROWS = 32  # 32-43: two rows J
SLOPES = 44  # 44-55: dg/d(h v_m)
WEIGHT = 56  # 56-57: of the rows in a condensed system; 0 if they do not act, -1 if their impulse is known
MISSING = 58  # 58-59: what a condensed system still lacks of its rows
FROZEN = 60  # 60-71, 72-83: scaled ROWS and scaled slopes of the factors of a condensed system
HINGE_COLUMNS = 84

# LINK
L_KIND, L_A, L_B, L_SIDE, L_SOFT = 0, 1, 2, 3, 4  # bodies as rows of LOCAL
L_ROW = 5  # first unknown of its impulses
L_ROWS = 6  # number of rows
L_JOINT = 7  # its row in JOINT
L_DUAL = 8  # its first unknown in a system in the rows alone
L_NEXT = 9  # 9, 10: as FIRST, the next joint on its body a, on its body b
LINK_COLUMNS = 11
# L_SOFT: 0 for rows that hold exactly; 1 for impulses within bounds; 2 where these count as given, for an answer; 3 for
# impulses within bounds that `boxes` finds.
BOUNDED, GIVEN, BOXED = 1, 2, 3

# SPAN: one row per island.
BODY_0, BODY_1, JOINT_0, JOINT_1 = 0, 1, 2, 3  # its slices of MEMBER and LINK
UNKNOWNS, BAND, LOOPS = 4, 5, 6  # size and half-width of its matrix; number of independent cycles of its graph
SYSTEM = 7  # below, WHOLE or CONDENSED
ROWS_OF = 8  # number of unknowns beside the matrix
DUAL_SIZE, DUAL_BAND = 9, 10  # of its matrix in the rows alone
RIGID = 11  # what a dual system is taken for: 2 everything, 1 what happens at an instant, 0 nothing
TAUT = 12  # 1 if its loops held by their pull in the last step (`taut`)
BOXES = 13  # most rows of bounded impulses that may act, if few enough for `boxes`; else 0
SPAN_COLUMNS = 14
# MEMBER: one row per body of each island.
M_BODY, M_COLUMN, M_FREEDOMS, M_CAYLEY, M_FIRST = 0, 1, 2, 3, 4
MEMBER_COLUMNS = 5

# FOUND (10,): 0, 1 side and instant of a limit that is passed first; 2-4 scratch of solutions;
NEAR = 5  # the error of a step that is near enough, 0 for round-off
EFFORT, BUDGET = 6, 7  # operations that solutions have taken since the step began; how many they may
LIMIT = 8  # of EFFORT, at which the step of an island gives up what its ladder has before linear rows
HURRY = 9  # likewise, from which on limits land instead of being met at their instants
FOUND = 10

NO_BEND, OWN_TURN, FULL_BEND = 0, 1, 2  # what of STIFF is there: nothing, [2, 2] and [5, 5], all

# What is solved for: the implicit step; poses or velocities that fit the joints; the step with rows of the start.
STEP, POSES, SPEEDS, LINEAR_STEP = 0, 1, 2, 3
# Systems: of bodies and rows; of bodies alone (`condensed`); of rows alone (`dual`).
WHOLE, CONDENSED, DUAL = 0, 1, 2
STIFFEST = 1e7  # rows in a condensed system, over the bodies' inertia
