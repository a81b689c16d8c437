"""The packed arrays of joints: what their columns mean.

JOINT (j, 76) float and TIE (j, 6) int: one row per joint, in the order of the space. Anchors stand in the frame of
their body, from its centre of mass. A joint's impulse `lam` acts along its rows J, which are the *discrete* gradient of
its function g over a step: g1 - g0 = J . (h v_m), v_m = (v0 + v1)/2, so that J^T lam does no work where g keeps still.

`SIDE` says where a joint with limits stands: -1 on the lower, 1 on the upper, 0 between them; then lam SIDE <= 0.
"""

# JOINT
ANCHOR_AX, ANCHOR_AY, ANCHOR_BX, ANCHOR_BY = 0, 1, 2, 3  # length
LENGTH = 4  # of a pin: length, > 0
LOWER, UPPER = 4, 5  # limits of a slide (length), of angle_b - angle_a (rad), of a groove's ends along it (length)
NORMAL_X, NORMAL_Y, OFFSET = 6, 7, 8  # of a groove, on body a: unit normal; n . (its points - centre of mass): length
STIFFNESS, DAMPING, REST = 4, 5, 6  # of springs: force/length, force time/length, length; torque/rad, ..., rad
PUSH = 7  # of springs: force (torque on b) added to the linear law
RATIO, PHASE = 4, 5  # of a gear: angle_b ratio - angle_a = phase
RATE = 4  # of a motor: spin_a - spin_b, rad/time
NOTCH = 4  # of a ratchet: angle_b - angle_a does not go back beyond it, rad
TOOTH, TOOTH_PHASE = 6, 7  # of a ratchet: angle between notches, signed; angle of one notch
MAX_FORCE = 9  # force or torque; infinite for a joint that holds exactly
ERROR_BIAS, MAX_BIAS = 10, 11  # share of an error that is left after a unit of time; fastest closing speed
IMPULSE_1, IMPULSE_2 = 12, 13  # impulse of the last step along the rows; of a spring along d, of a rotary one on b
LAST_STEP = 14  # its dt; 0 if none
LENGTH_0, LENGTH_1 = 15, 16  # of springs: length, or angle_a - angle_b, at the ends of the last step
WORK = 17  # energy that the joint gave to its bodies in the last step
LED = 18  # 18-20, 21-23: accelerations that joints gave to bodies a and b last
COUNTED, COUNTED_OF = 24, 25  # parts of steps of order 4 that are known (`foresight`); the length of their steps
PAST_LED = 26  # 26-61: accelerations of bodies a and b along their three ways in these parts, six each
PAST_PUSH = 62  # 62-73: impulses along two rows, over the lengths of the parts, six each
OWED = 74  # of the first joint of an island: energy that steps whose joints did not hold have taken
COMPLIANCE = 75  # likewise: with which compliance (time²) its joints have given way in the last step, 0 if they held
JOINT_COLUMNS = 76

# TIE
KIND = 0  # below
BODY_A, BODY_B = 1, 2  # rows of its bodies
SIDE = 3
SOFT = 4  # 1 if max_force is finite: rows of velocity at the end of the step, |lam| <= max_force h
TOUCHED = 5  # 1 if the user changed the joint or its bodies since the last step; 2 if it is still apart from that; 3 if
# linear rows of a step left it so, 4 if it gives way elastically
TIE_COLUMNS = 6

# KIND
PIN, PIVOT, GROOVE, SLIDE, SPRING = 0, 1, 2, 3, 4
GEAR, ROTARY_LIMIT, RATCHET, MOTOR, ROTARY_SPRING = 5, 6, 7, 8, 9

# LEDGER: energies of a step of an island. K is kinetic energy, W the work of the bodies' constant accelerations:
# K1 - K0 - W + STORED = MOTORS + SUPPORTS + CLOSED - DAMPED - LIMITED - CLAMPED - PROJECTED
STORED = 0  # change of what springs hold
DAMPED = 1  # loss >= 0 in damped springs
LIMITED = 2  # loss >= 0 at limits
CLAMPED = 3  # loss >= 0 in joints that slip at their max_force
PROJECTED = 4  # loss >= 0 of velocities that violated joints
MOTORS = 5  # work of motors, and of joints with a finite max_force where it is positive
SUPPORTS = 6  # work of bodies that move without being moved
CLOSED = 7  # work of closing joints that were apart at the start, of elastic stand-ins, of linear steps
LEDGER_COLUMNS = 8

# Status of an island's step.
EXACT = 0  # joints hold to round-off
HALVED = 1  # the step was taken in parts
ELASTIC = 2  # joints gave way elastically in some part
LINEAR = 3  # rows of the start held at mid-velocity in some part: energy kept, joints to O(h^2)
