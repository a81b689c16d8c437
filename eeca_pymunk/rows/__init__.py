"""The solver of contact rows: impulses of all contacts of one island or impact, on arrays in local numbering.

In: the rows of m contacts (`..model.contacts.Row`), the bodies' velocities, and how impulses change these: inverse
masses (`Problem`), or the response columns of jointed bodies (`JointedProblem`, `columns.py`, `bounded.py`). Out:
impulses, velocities, losses. Only the innermost loops differ between both: a `Choice` calls the one for the type of the
problem. Users: impacts at one instant (`blocks.py`, solved to round-off unless there is friction), and islands over an
interval (`..contacts`, `..jointed`), which begin with the impulses of the last one and have a budget.

Open `build.py` first, the row of a contact. A solve alternates between

* projected Gauss-Seidel sweeps (`sweeps.py`), accelerated by `conjugate.py`, with the law of one contact in closed form
  (`coulomb.py`);
* direct solves on the active contacts (`direct.py`; `active_set.py` says which these are): by `dense.py` for few
  contacts, else by `sparse.py` with the factor of `cholesky.py`, in the order of `dissection.py`;
* or, for up to some dozen contacts, homotopies (`laws.py`, `homotopy.py`, `homotopy_start.py`, `pivots.py`).

Where there is no solution, or only one of excessive impulses, friction is left out, or sweeps are few (`gentle.py`).
`equilibrium.py` finds contact forces that balance, on the edges of friction cones (`cones.py`); `energy.py` computes
losses, and scales impulses that would give energy; `lifting.py` moves bodies out of each other.

Symbols: u_n, u_t are the normal and tangential velocity of a contact, u- before its impulses and u+ after; e its
elasticity, mu its friction, b its target; lam, beta its impulses along n and t; j, G, T rows of velocities along n and
t (`..model.contacts.Row` defines all of these). A = (G, T) M^-1 (G, T)^T, with M the masses, is the change of all
velocities by unit impulses, A_nn one of its diagonal entries; W is M^-1 or the response of jointed bodies. D_n, D_t are
losses, energies (`energy.py`).

Names of arguments: ROWS (m,) between local bodies; L (m, 2) impulses lam and beta; V (k, 3) velocities,
FREE those without impulses; IM, II (k,) inverse masses and moments; the first n of the k bodies move. `worst` is the
largest change of a contact's velocity in the last sweep, by which solves end. R is the stiffness of the augmentation of
a direct solve, dimensionless. active, stuck, slope, target_t are the active set (`active_set.classify`); G, EDGE (K,)
edges of friction cones (`cones.py`).
"""
