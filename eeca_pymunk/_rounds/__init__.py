"""The rounds of `TimeOfImpact` on numpy arrays, and the contact geometry that goes with them.

In: arrays of a step's start and the pairs of the margin twin. Out: velocities, displacements and the log of impacts.

Open first `steps.py`, then `rounds.py`. To be replaced by the compiled event loop; nothing new belongs here.
"""
