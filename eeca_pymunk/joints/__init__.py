"""Joints: the energy-momentum step of components, bodies that hang together by joints, without contacts.

In: BODY rows (poses, velocities, accelerations, mobilities), JOINT rows, a step. Out: poses and velocities at its end,
impulses, the ledger of each component, a status.

Open `step.py` first, the step of a component, by Newton's method (`..newton`): `start.py` reads its joints,
`closing.py` and `correct.py` mend what users break, `ladder.py` takes the step, `unheld.py` what does not converge.
`limits.py` meets bounds (`bounds.py`) at their instant. `foresight.py` has first iterates, `ledger.py` and `lock.py`
the energies. `plan.py` finds components and the order of their unknowns (`ordering.py`), `held.py` bodies that cannot
move at all.
"""
