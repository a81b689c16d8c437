"""What crosses the edge to pymunk: one row or column per body in the order in which pymunk walks its bodies, static
ones included.

STATES (2, N, 9) float: the state that was read, and what the step before has left there (NaN: nobody knows); columns
position, angle, velocity, spin, force, torque. WALK (4, N) int. EXTRA (N, 5) float. ENDS (18 N) float: four tables as
pymunk's batch calls want them: (N, 6) pose and velocity at the end of the step; (N, 6) that pose with velocity 0, and
(N, 3) that velocity, for a step of pymunk in between; (N, 3) forces, reset. Where nothing turns the first three have no
columns of angle and spin.
"""

# STATES
NOW, LEFT = 0, 1
STATE_COLUMNS = 9
# WALK
FOUND, KNOWN = 0, 1  # pymunk's ids of the bodies as read, and as they were when the rows were made
BODY_ROW = 2  # row of BODY, -1 for static bodies
SPECIAL = 3  # 0 for most; bits of what EXTRA has to say
STEERED, ECCENTRIC = 1, 2  # the body's own function has chosen its acceleration; its centre of mass is not its origin
# `due` of bodies in BODY at the start of a step: to be forecast anew as if put where they are, their shapes' sides kept
ANEW = -2.0
# EXTRA
COG_X, COG_Y = 0, 1  # centre of mass in the body's coordinates: length
PUSH_X, PUSH_Y, PUSH_TWIST = 2, 3, 4  # acceleration of a steered body: length/time², rad/time²
EXTRA_COLUMNS = 5
# ENDS
END, STILL, SPEED, PULL = 0, 6, 12, 15  # where each begins, in N
END_COLUMNS = 18
