"""The equations of EECA on arrays: balance, weights, the energy lock, energy and momenta.

In: masses, velocities, normals, impulses. Out: psi1, psi2, the scale of the lock, sums of energy and momentum.

Open first `balance.py`, the paper's equations with their numbers. `invariants.py` sums energy and momenta.
`delassus.py` is the operator A = G M^-1 G^T of contacts, `complementarity.py` solves 0 <= lam _|_ A lam + q >= 0 with
it, `graph.py` tells which bodies hang together. Nothing here knows of pymunk, time steps or shapes.
"""
