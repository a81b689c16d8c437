"""Bodies held by joints in the event loop: their islands, contacts among them, and impacts on them.

`layout` arrays of the joints; `component` steps what hangs together by joints and finds how it answers impulses;
`columns` solves contact laws with these answers in the place of masses; `solve` the span of an island, `strike` an
impact at one instant, `loop` the step, `scene` its arrays. A scene without joints knows nothing of this room.
"""
