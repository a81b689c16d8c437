"""Stand-in until the room is there.

In: joints. Out: steps. Open first `scene.py`.
"""
