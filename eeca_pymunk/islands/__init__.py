"""Islands: bodies in persistent contact; over which interval each is solved, and which of them are at rest.

In: the contacts that the last step has left, impacts after which contacts persist. Out: bodies on parabolas until the
interval ends, contacts with their impulses, works in the ledger.

An *interval* leads from an instant to the end of the step, or ends earlier; the contacts of the island exert constant
forces over it. A *hit* is an impact on an island within its interval, which it cuts. *Lossy* are shapes of elasticity
below 1, and islands with such a shape (`membership.lossy`); a pair *loses* if its law has an elasticity below 1. The
*load* of a contact is its force without the part that stops an approach. A body is *busy* for some steps after its
island was hit more often than a step allows, or as often with joints and without bounces, or once half of the work of
the step is spent: all that comes near then joins the island.

Open `building.py` first: islands at the start of a step (`membership.py`: which bodies, which contacts persist;
`hits.py`: how many hits a step allows). `intervals.py` solves one (`candidates.py`: pairs and length of the interval;
`depths.py`: how deep contacts may close; `local.py`: its bodies in local numbering); `payment.py` says what pays for
penetration corrections; `accounting.py` ends it, `shortened.py` replaces the forces of a shortened interval that have
given energy, `loads.py` has what the bodies of an island bear; `turned.py` keeps the angular momentum of bodies in
flight.

States of rest, `Member.rest` of the root of an island, and the transitions between them:

    AWAKE      solved in every step. Entered from AT_REST at the instant of an impact (`accounting.py`), and at the
               start of a step after an edit, a motion of the support, or a change of forces (`at_rest.py`); in between
               the island is CHANGED.
    AT_REST    an island, or the part of it, for which `..contacts.statics` finds static forces (`rest.py`,
               `intervals.py`, `partial_rest.py`), or one with joints that a whole step has left as it was
               (`..jointed.rest`). Left also where contacts of the island cannot support the bodies that move on it
               (`support.py`).

`space/sleeping.py` turns islands at rest into pymunk's sleepers after `space.sleep_time_threshold`.

Names of arguments: A is the scene; `root` the first body of an island, MINE its n bodies; a, b shapes, i, j bodies; t
an instant after the start of the step, h the length of an interval; `isle` the island in local numbering, ROWS its
m contacts (`..model.islands`).
"""
