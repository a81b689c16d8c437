"""The arrays exchanged with pymunk: one row or column for each body, in pymunk's own order, static ones included.

STATES (2, N, 9) float: the state that was read (NOW), and the state at the end of the last step (LEFT; NaN: unknown).
Columns: position, angle, velocity, spin, force, torque. WALK (4, N) int: ids, rows and flags of the bodies. EXTRA
(N, 5) float: values for bodies with flags. ENDS (18 N + 1) float: four tables in the form of pymunk's batch calls,
(N, 6) pose and velocity at the end of the step; (N, 6) this pose with velocity 0, and (N, 3) this velocity, for a rest
step in between; (N, 3) forces, reset; then the energy lost by damping 0. If no body rotates, the first three have no
columns of angle and spin. HELD (6, N, 9) float: states and changes in steps that call functions of the program.
"""

# STATES
NOW, LEFT = 0, 1
STATE_COLUMNS = 9
# WALK
FOUND, KNOWN = 0, 1  # pymunk's ids of the bodies: as read now, as read when the rows were made
BODY_ROW = 2  # row of BODY, -1 for static bodies
SPECIAL = 3  # flags: 0 for most bodies, or the bits below; EXTRA has their values
STEERED, ECCENTRIC = 1, 2  # a velocity function has set the acceleration; the centre of mass is not the origin
# `Body.due` at the start of a step: the body counts as placed by the program, but the sides of its shapes are kept;
# less than NUDGED by the way that it was moved, over its extent: sides of shapes that are not as wide are forgotten
ANEW, NUDGED = -2.0, -3.0
# EXTRA
COG_X, COG_Y = 0, 1  # centre of mass in the body's coordinates: length
PUSH_X, PUSH_Y, PUSH_TWIST = 2, 3, 4  # acceleration of a steered body: length/time², rad/time²
EXTRA_COLUMNS = 5
# ENDS
END, STILL, SPEED, PULL = 0, 6, 12, 15  # where each begins, in N
END_COLUMNS = 18
# HELD: changes by functions before the bodies move, and afterwards; the state at the start of the step, at the start of
# the rehearsal, and before a function was called; the end of the step without changes by functions
EARLY, LATE, START, REHEARSED, SEEN, UNALTERED = 0, 1, 2, 3, 4, 5
HELD = 6
