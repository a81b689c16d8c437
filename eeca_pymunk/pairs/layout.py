"""The arrays of the near lists: what their columns mean.

MARK (k, 8) float: the margin circle of each shape, drawn about where its list was made or ahead of that, and its
neighbours in the grid. CELL (k, 2) int: its place there. LIST (k, 4) int: where in POOL its neighbours stand. POOL
int32: numbers of shapes, all lists one after the other; FLAG, of the same length, 1 where an island's solve has taken
the pair over, so that it makes no events. INFO int: counters of the lists.
"""

# MARK
AT_X, AT_Y = 0, 1  # centre of the margin circle, length: where that of the bounding circle was, or a way before it
MARGIN = 2  # how far it may go from there: length; infinite where every shape is in every list
REACH = 3  # of the bounding circle and the margin from the centre, as the grid has it
NEXT, PREVIOUS = 4, 5  # shapes in the same place of the grid, -1 for none: beside what a search compares, in one line
MARK_COLUMNS = 8

# CELL
LEVEL, BUCKET = 0, 1
CELL_COLUMNS = 2

# LIST
START, CAPACITY, NUMBER = 0, 1, 2
LATER = 3  # whom a lone disk meets if it goes straight on when it leaves its circle (`..impacts.forecast`)
LIST_COLUMNS = 4

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
