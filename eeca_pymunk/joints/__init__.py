"""Joints: the energy-momentum step of components, bodies that hang together by joints, without contacts.

In: BODY rows (poses, velocities, accelerations, mobilities), JOINT rows, a step. Out: poses and velocities at its end,
impulses, the ledger of each component, a status.

Open `rows.py` first (the equations of all ten joints; `points.py`, `angles.py`, `springs.py` have their rows), then
`step.py`, the step of a component: `start.py` reads its joints, `closing.py` and `correct.py` mend what users break,
`ladder.py` takes the step, `unheld.py` what does not converge. `limits.py` meets bounds at their instant and calls
`solve.py`, Newton's iteration; `newton.py` has its linear systems, of `entries.py`, `bounded.py` and `boxes.py`
(bounded impulses), which `banded.py`, `condensed.py` and `dual.py` solve. `plan.py` finds components and the order of
their unknowns (`ordering.py`), `response.py` how they answer impulses, `held.py` bodies that cannot move at all.
"""
