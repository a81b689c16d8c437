"""Joints: the energy-momentum step of components, bodies that hang together by joints, without contacts.

In: BODY rows (poses, velocities, accelerations, mobilities), JOINT rows, a step. Out: poses and velocities at its end,
impulses, the ledger of each component, a status.

Open `step.py` first, the step of a component, by Newton's method (`..newton`): `start.py` reads its joints,
`closing.py` and `correct.py` mend what users break, `ladder.py` takes the step, `unheld.py` what does not converge.
`limits.py` meets bounds (`bounds.py`) at their instant. `foresight.py` and `taut.py` say how solutions begin,
`ledger.py` and `lock.py` have the energies. `plan.py` finds components and the order of their unknowns
(`ordering.py`), `workspace.py` has their memory; `pinned.py` finds bodies that cannot move at all
(`straight.py`, `welds.py`).

Symbols and names of arguments are those of `..newton`. `left apart`: of joints that linear rows of an earlier step have
left off their targets, not the user; `own` says that there are only such.
"""
