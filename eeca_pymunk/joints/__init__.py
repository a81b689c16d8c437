"""Joints: the energy-momentum step of islands of jointed bodies without contacts.

In: BODY rows (poses, velocities, accelerations, mobilities), JOINT rows, a step. Out: poses and velocities at
its end, impulses, the ledger of each island, a status. Open `rows.py` first (the equations of all ten joints), then
`newton` and `solve` (the implicit step; `banded`, `condensed` and `dual` solve its linear systems), `limits` (bounds
met at their instant), `step` (one island, its ladder, order 4; `foresight` says what it begins with), `plan` (islands,
order of unknowns), `world` (all islands in one call). `start` and `correct` mend what users break.
"""
