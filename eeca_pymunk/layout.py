"""The arrays exchanged with pymunk: one row or column for each of N bodies, in pymunk's order, static ones included.

| array | shape | contents |
|---|---|---|
| STATES | (2, N, 9) | the state as read from pymunk, and as written at the end of the last step (NaN: unknown) |
| IDS | (4, N) int | ids, rows and flags of the bodies |
| EXTRA | (N, 5) | values for bodies with flags |
| ENDS | (9 N + 1) | two tables in the form of pymunk's batch calls, then the energy lost by damping 0 |
| HOOKED | (6, N, 9) | states and changes in steps that call functions of the program |

The columns of STATES and HOOKED are position (2), angle, velocity (2), spin, force (2), torque. The tables of ENDS are
(N, 6) pose and velocity at the end of the step; (N, 3) forces, reset. If no body rotates, the first has no columns of
angle and spin.
"""

# STATES
READ, WRITTEN = 0, 1
STATE_COLUMNS = 9
# IDS
READ_ID, KNOWN_ID = 0, 1  # pymunk's ids of the bodies: as read now, as read when the rows were made
BODY_ROW = 2  # row of BODY, -1 for static bodies
FLAGS = 3  # 0 for most bodies, or the bits below; EXTRA has their values
# A velocity function has set the acceleration; the centre of mass is not the origin; a static body was moved.
STEERED, ECCENTRIC, MOVED = 1, 2, 4
# `Body.due` at the start of a step. PLACED: the body counts as placed by the program, but the sides of its shapes are
# kept. SHIFTED - w: it was moved by w times its extent; sides of shapes that are thinner than that are forgotten.
PLACED, SHIFTED = -2.0, -3.0
# EXTRA
COG_X, COG_Y = 0, 1  # centre of mass in the body's coordinates: length
ACCELERATION_X, ACCELERATION_Y, ANGULAR_ACCELERATION = 2, 3, 4  # of a steered body: length/time², rad/time²
EXTRA_COLUMNS = 5
# ENDS
END, RESET_FORCES = 0, 6  # where each begins, in N
END_COLUMNS = 9
# HOOKED: changes by functions before the bodies move, and afterwards; the state at the start of the step, at the start
# of the rehearsal, and before a function was called; the end of the step without changes by functions
CHANGES_BEFORE, CHANGES_AFTER, START, REHEARSAL_START, BEFORE_CALL, UNALTERED = 0, 1, 2, 3, 4, 5
HOOKED_TABLES = 6
