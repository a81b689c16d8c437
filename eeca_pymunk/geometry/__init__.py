"""Where bodies are, how far shapes are apart, and where they touch: compiled functions of the packed arrays.

In: the arrays of `layout`, shape numbers, poses (x, y, angle) of their bodies. Out: gaps (negative in overlap), unit
normals from a to b, points halfway between the two surfaces.

Open first `gap.py`, the only place that decides a gap's sign. `flight.py` has the paths of bodies, `convex.py` the
distances of convex cores, `manifold.py` the two contact points of faces. Imports `layout` and `compiled` alone.
"""
