"""Where bodies are, how far shapes are apart, and where they touch.

In: the arrays of a scene (`..model.scene`), shape numbers, poses (x, y, angle) of their bodies. Out: gaps (negative in
overlap), unit normals from a to b, points halfway between the two surfaces.

Open first `gap.py`, the only place that defines a gap's sign. `flight.py` has the paths of bodies, `convex.py` the
distances of convex cores, `manifold.py` the two contact points of faces, `sides.py` and `corners.py` the sides of thin
shapes, `separation.py` distances of cores along the normals of their edges, `widths.py` how thin they are.
"""
