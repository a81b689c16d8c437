"""Islands: bodies in contact that lasts; over which interval each is solved, and which of them are at rest.

In: the contacts that the last step has left, impacts that end in contact. Out: bodies on parabolas until the interval
ends, contacts with their impulses, works in the ledger. Open `building.py` first: islands at the start of a step
(`membership.py`: which bodies, which contacts persist; `penetration.py`: what was put into one another). `intervals.py`
solves one (`candidates.py`: pairs and length of the interval; `depths.py`: how deep contacts may close; `local.py`: its
bodies as the solver takes them); `accounting.py` ends it, `excess.py` takes back energy that a shorter one has gained.

States of rest, `Member.rest` of the first body of an island, and what leads from one to another:

AWAKE      solved in every step. Entered from the others by a touch, an edit, a support that moves, other forces
           (`at_rest.py`); each sets CHANGED, and the start of the next step wakes the island.
CANDIDATE  at the end of a step without impacts in which all its bodies were slower than REST_SPEED (`rest.py`).
AT_REST    for a candidate whose contacts neither slip nor are driven (`accounting.py`); for an island, or the part of
           it, for which `..contacts.statics` finds static forces (`intervals.py`, `partial_rest.py`). Left also where
           the island does not bear what moves on it (`support.py`).

`space/sleeping.py` turns islands at rest into pymunk's sleepers after `space.sleep_time_threshold`.
"""
