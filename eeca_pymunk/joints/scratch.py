"""The scratch arrays of one island: what their columns mean.

LOCAL (n, 40) float and NODE (n, 2) int: one row per body of the island, those that joints cannot move included.
HINGE (m, 24) float and LINK (m, 8) int: one row per joint. ONE (12, 6): a joint's row vectors at the present iterate;
columns 0-2 are for body a, 3-5 for body b: along x, along y, about the centre of mass.

Over a step h the bodies take the way h v_m = h (v0 + v1)/2 and turn by 2 atan(chi/2), chi = h w_m (Cayley), for then
r1 - r0 = chi z x r_m with r_m = (r0 + r1)/2 exactly, and energy and angular momentum are kept both. A body that no
joint holds off its centre of mass, and one that cannot be turned, turns by chi; its levers are tan(chi/2)/(chi/2) r_m.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

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
LOCAL_COLUMNS = 40

# NODE
COLUMN, FREEDOMS = 0, 1  # first unknown of the body, number of its unknowns: 0, 2 (joints do not turn it) or 3
NODE_COLUMNS = 2

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
TOTAL = 20  # 20-21: impulse over all parts of the step
PUSHED = 22  # 22-23: impulse of a correction
HINGE_COLUMNS = 24

# LINK
L_KIND, L_A, L_B, L_SIDE, L_SOFT = 0, 1, 2, 3, 4  # bodies as rows of LOCAL
L_ROW = 5  # first unknown of its impulses
L_ROWS = 6  # number of rows
L_JOINT = 7  # its row in JOINT
LINK_COLUMNS = 8

# ONE
FORCE, VALUE, ROWS, SLOPES, STIFFNESS = 0, 1, 2, 4, 6  # J^T lam; g; J (2, 6); dg/d(h v_m) (2, 6); dF/d(h v_m) (6, 6)
ONE_ROWS = 12
NO_BEND, OWN_TURN, FULL_BEND = 0, 1, 2  # what of STIFFNESS is there: nothing, [2, 2] and [5, 5], all
