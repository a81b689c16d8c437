"""The solver of contact rows: impulses of all contacts of one island or block, on arrays in local numbering.

In: the rows of m contacts (`..model.contacts.Row`), the bodies' velocities and mobilities. Out: impulses,
velocities, losses. Two users: blocks of contacts that hit at one instant (`blocks.py`, to round-off), and islands that
rest, slide and roll (the room `sustained`: bounded work, warm start). Both alternate projected Gauss-Seidel sweeps
(`sweeps.py`, accelerated by `conjugate.py`) with a direct solve on the active contacts (`direct.py`: `dense.py` for few
contacts, else `polish.py` on the sparse factor of `cholesky.py`); `equilibrium.py` finds forces that balance;
`energy.py` takes losses, scales impulses that would give energy, and lifts bodies out of each other.
Open `build.py` first.
"""
