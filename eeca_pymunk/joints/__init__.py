"""Joints: the energy-momentum step of components (bodies connected by joints) without contacts.

In: BODY rows (poses, velocities, accelerations, mobilities), JOINT rows, a step. Out: poses and velocities at its end,
impulses, the ledger of each component, a status.

Open `step.py` first, the step of a component, by Newton's method (`..newton`): `start.py` reads its joints,
`closing.py` and `correct.py` close joints that edits have opened, `ladder.py` takes the step, divided where it does not
converge, `unheld.py` steps that do not converge at all. `limits.py` meets bounds (`bounds.py`) at their instant.
`foresight.py` predicts with what solutions begin, `ledger.py`, `frame.py`, `lock.py` and `gains.py` have the energies.
`plan.py` finds components and the order of their unknowns (`ordering.py`), `workspace.py` has their memory;
`partners.py` reads bodies that only the program moves, `pinned.py` finds those that cannot move at all (`straight.py`,
`welds.py`).

Symbols and names of arguments are those of `..newton`. At one instant, for POSES and SPEEDS, h is 2: a change of v1
then is the displacement, or the change of velocity, itself. *Left apart* are joints that an earlier step solved by
linear rows has left off their targets, not an edit; `own` says that none is apart by an edit.
"""
