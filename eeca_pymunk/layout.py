"""The packed arrays that all kernels share: what their columns mean.

BODY (n, 16) float: one row per body. Rows [0, disks) are dynamic bodies with one shape, a circle about the centre of
mass; then the other dynamic bodies; then kinematic ones; the last row is the ground, on which all static shapes stand
(pose and velocity 0, no mobility, shapes in world coordinates). A body's path from `SINCE` on, an instant counted from
the start of the step, is the parabola

    q(t) = q + v s + a s^2 / 2,   s = t - SINCE,   of each of x, y and the angle.

SHAPE (k, 9) float and LINK (k, 6) int: one row per solid shape, ordered by body row, so that the shape of a lone disk
has the number of its body. VERTEX (v, 4): the vertices of all shapes, counter-clockwise about the centre of mass in the
body's frame, and the outward unit normal of the edge that begins there (0 for a point). One vertex is a disk, two are a
segment (with two edges, one for each side), more a polygon; `ROUNDING` rounds them all.
"""

# BODY
X, Y, ANGLE = 0, 1, 2  # pose of the centre of mass at SINCE: length, length, rad
VX, VY, SPIN = 3, 4, 5  # velocity there: length/time, rad/time
SINCE = 6  # time after the start of the step
EXTENT = 7  # length from the centre of mass to the farthest point of the body's shapes; the radius of a lone disk
AX, AY, TWIST = 8, 9, 10  # acceleration, constant from SINCE on: length/time², rad/time²
IM, II = 11, 12  # 1/mass, 1/moment; 0 for what impulses do not move
BOUNCE, GRIP = 13, 14  # elasticity and friction of a lone disk
DUE = 15  # time after the start of the step of the body's next event
BODY_COLUMNS = 16

# SHAPE
ROUNDING = 0  # length, radius of a circle, of a segment's or polygon's rounding
SIZE = 1  # length from the body's centre of mass to the shape's farthest point
ELASTICITY, FRICTION = 2, 3
SURFACE_X, SURFACE_Y = 4, 5  # surface velocity, length/time
CENTRE_X, CENTRE_Y = 6, 7  # of the shape's bounding circle, in the body's frame: length
BOUND = 8  # radius of that circle: length
SHAPE_COLUMNS = 9

# LINK
OWNER = 0  # row of the body
FIRST, COUNT = 1, 2  # first vertex, number of vertices
GROUP, CATEGORIES, MASK = 3, 4, 5  # of the shape's filter
LINK_COLUMNS = 6

# EVENT (m, 11) float: one row per impulse of a step
FIRST_SHAPE, SECOND_SHAPE = 0, 1  # rows of SHAPE of a and of b
WHEN = 2  # time after the start of the step
IMPULSE = 3  # normal impulse, mass length/time, >= 0
NORMAL_X, NORMAL_Y = 4, 5  # unit, from a to b
POINT_X, POINT_Y = 6, 7  # length, halfway between the surfaces at that instant
GAP = 8  # length, at the start of the step, negative in overlap
CHANGE = 9  # of the contact's normal velocity by this impulse alone, length/time
TANGENTIAL = 10  # impulse along t = (-n_y, n_x), mass length/time
EVENT_COLUMNS = 11

# What crosses the edge to pymunk, one row or column per body in the order in which pymunk walks its bodies, static ones
# included.
# STATES (2, N, 9) float: the state that was read, and what the step before has left there (NaN: nobody knows); columns
# position, angle, velocity, spin, force, torque.
NOW, LEFT = 0, 1
STATE_COLUMNS = 9
# WALK (4, N) int
FOUND, KNOWN = 0, 1  # pymunk's ids of the bodies as read, and as they were when the rows were made
BODY_ROW = 2  # row of BODY, -1 for static bodies
SPECIAL = 3  # 0 for most; bits of what EXTRA has to say
STEERED, ECCENTRIC = 1, 2  # the body's own function has chosen its acceleration; its centre of mass is not its origin
# EXTRA (N, 5) float
COG_X, COG_Y = 0, 1  # centre of mass in the body's coordinates: length
PUSH_X, PUSH_Y, PUSH_TWIST = 2, 3, 4  # acceleration of a steered body: length/time², rad/time²
EXTRA_COLUMNS = 5
# ENDS (18 N) float: four tables as pymunk's batch calls want them: (N, 6) pose and velocity at the end of the step;
# (N, 6) that pose with velocity 0, and (N, 3) that velocity, for a step of pymunk in between; (N, 3) forces, reset.
# Where nothing turns the first three have no columns of angle and spin.
END, STILL, SPEED, PULL = 0, 6, 12, 15  # where each begins, in N
END_COLUMNS = 18
