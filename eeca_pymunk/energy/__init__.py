"""The paper's equations on arrays, the ledger, energy and momenta.

In: masses, velocities, normals, impulses. Out: the weights psi1 and psi2, the scale of the energy lock, sums of energy
and momentum, ledgers.

Open first `balance.py`, the paper's equations with their numbers, as `Dashpot` and the penalty steppers use them: with
`delassus.py`, the operator A = G M^-1 G^T of contacts, and `complementarity.py`, which solves 0 <= lam _|_ A lam + q
>= 0 with it. All steppers use `invariants.py`, sums of energy and momenta, and `ledger.py`. The energy lock of the
compiled step is in `..rows.energy`. Nothing here uses pymunk.
"""
