"""The counters and lengths of the near lists and their grids: what their places mean.

INFO int: counters of the lists. GRID float: lengths of the two grids.
"""

# INFO
POOL_END = 0  # first free place of POOL
MOVING = 1  # shapes [0, MOVING) move and have lists, the others are static
WALL_COLUMNS, WALL_ROWS = 2, 3  # cells of the grid of static shapes; 0 where all of them are looked at
LEAVES = 4  # lists made anew, of one shape each
LEVELS = 5  # INFO[LEVELS + l]: shapes on level l of the grid
LEVEL_COUNT = 64
CHOSEN = LEVELS + LEVEL_COUNT  # INFO[CHOSEN:]: scratch, shapes that a loop has chosen, which one after it looks at
ROOM = 64  # for so many. Whom to choose cannot be guessed: a branch would wait for one row after the other
WALKED = CHOSEN + ROOM  # INFO[WALKED:]: scratch, one shape in each of so many places of the grid
INFO_LENGTH = WALKED + ROOM

# GRID float: lengths of the two grids
CELL_LENGTH = 0  # of level 0; level l has cells twice as long as l - 1
WALL_X, WALL_Y, WALL_LENGTH = 1, 2, 3  # corner and cell of the grid of static shapes
GRID_LENGTH = 4
