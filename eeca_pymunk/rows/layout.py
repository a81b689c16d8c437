"""The arrays of one island or block: what their columns mean.

Local bodies are rows [0, n) that impulses move, and rows [n, k) that they do not: the ground (velocity 0) and
kinematic bodies. V (k, 3) velocities (length/time, length/time, rad/time), IM and II (k,) 1/mass and 1/moment, 0 for
what impulses do not move; POSE (k, 3) x, y, angle. Contact i acts between bodies A[i] and B[i] (int64) along n, the
unit normal from A to B, and t = (-n_y, n_x):

    u_n = n.(v_b - v_a) + arm_nb w_b - arm_na w_a,   arm_n = r x n,  r from the centre of mass to the point,
    u_t = t.(v_b - v_a) + arm_tb w_b - arm_ta w_a + surface,   arm_t = r x t.

L (m, 2): the normal impulse lam >= 0 and the tangential one on B. ROWS (m, 22):
"""

NX, NY = 0, 1  # unit normal from A to B
ARM_NA, ARM_NB = 2, 3  # arms of the normal impulse: length
ARM_TA, ARM_TB = 4, 5  # arms of the tangential impulse: length
GAP = 6  # length, negative in overlap
UN, UT = 7, 8  # u_n and u_t before the impulses, without what forces add in a step: length/time
K_N, K_T = 9, 10  # masses that the contact feels, 1 / A_nn and 1 / A_tt
ELASTICITY, FRICTION = 11, 12  # of the contact: products of both shapes' values
TARGET = 13  # b: the law is 0 <= lam _|_ u_n - b >= 0
SURFACE = 14  # t.(surface velocity of B's shape - that of A's): length/time
WAKE = 15  # the contact acts once u_n without its own impulse falls below this; infinity while it acts
A_NN, A_NT, A_TT = 16, 17, 18  # what a unit impulse changes of u_n and u_t: 1/mass
W_NN, W_NT, W_TT = 19, 20, 21  # the inverse of these, with friction; nan where they are singular: mass
ROW_COLUMNS = 22
