"""Parts that interlock, built here, and how each scene puts them up. Lengths are in the unit of the part."""
import math

# Side view of a log, one character a cell: two notches above, two below, so that crossed logs lock.
LOG = ("###.......####.......###",
       "########################",
       "########################",
       "########################",
       "########################",
       "###.......####.......###")
LOG_DEPTH = 5      # cells; a notch is two wider, so that the cages of crossed logs have room
CELL_DIVISIONS = 2
LINK_RINGS, LINK_SIDES = 96, 24
LINK = (1.0, 1.0, 0.35)  # half the straight part, radius of the bends, radius of the tube
LINK_SLACK = 0.3
PILE_GAP = 0.05    # between the parts of a pile, in diagonals


def divided(picture, times):
    return ["".join(cell * times for cell in row) for row in picture for _ in range(times)]


def extruded(picture, depth):
    """Surface of the cells, extruded: unit cubes, of which the faces between two are left out; triangles."""
    solid = {(x, y, z) for z, row in enumerate(reversed(picture)) for x, cell in enumerate(row) if cell == "#"
             for y in range(depth)}
    indices, triangles = {}, []
    for cell in sorted(solid):
        for axis in range(3):
            for side in (0, 1):
                step = [0, 0, 0]
                step[axis] = 2 * side - 1
                if tuple(c + s for c, s in zip(cell, step)) not in solid:
                    triangles += square(cell, axis, side, indices)
    return list(indices), triangles


def square(cell, axis, side, indices):
    """Two triangles that look outward."""
    corners = []
    for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)):
        offset = [0, 0, 0]
        offset[axis], offset[(axis + 1) % 3], offset[(axis + 2) % 3] = side, u, v
        corners.append(tuple(c + o for c, o in zip(cell, offset)))
    a, b, c, d = (indices.setdefault(corner, len(indices)) for corner in corners)
    return [(a, b, c), (a, c, d)] if side else [(a, c, b), (a, d, c)]


def log():
    points, triangles = extruded(divided(LOG, CELL_DIVISIONS), LOG_DEPTH * CELL_DIVISIONS)
    half = [len(LOG[0]) / 2, LOG_DEPTH / 2, len(LOG) / 2]
    return [tuple(x / CELL_DIVISIONS - h for x, h in zip(p, half)) for p in points], triangles


def link_centre_line():
    """Points and outward directions along a stadium in the xz plane, equally many on bends and straights."""
    straight, bend, _ = LINK
    quarter = LINK_RINGS // 4
    for i in range(LINK_RINGS):
        part, t = divmod(i, quarter)
        t /= quarter
        angle = math.pi * (t if part == 0 else 1 if part == 1 else 1 + t if part == 2 else 0)
        along = straight * (1 if part == 0 else 1 - 2 * t if part == 1 else -1 if part == 2 else 2 * t - 1)
        out = (math.cos(angle), 0.0, math.sin(angle))
        yield (bend * out[0], 0.0, bend * out[2] + along), out


def link():
    tube = LINK[2]
    points = []
    for centre, out in link_centre_line():
        for j in range(LINK_SIDES):
            angle = 2 * math.pi * j / LINK_SIDES
            radial, across = tube * math.cos(angle), tube * math.sin(angle)
            points.append((centre[0] + radial * out[0], across, centre[2] + radial * out[2]))
    index = lambda i, j: i % LINK_RINGS * LINK_SIDES + j % LINK_SIDES
    triangles = []
    for i in range(LINK_RINGS):
        for j in range(LINK_SIDES):
            a, b, c, d = index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)
            triangles += [(a, c, b), (a, d, c)]
    return points, triangles


def place(x, y, z, degrees=0.0, fixed=False):
    """The part turned about the vertical and moved."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return {"matrix": [[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, z], [0, 0, 0, 1]], "fixed": fixed}


def chain_places(links=6):
    """A chain that hangs from its first link, each link turned by 90 degrees, a little slack in every joint."""
    straight, bend, tube = LINK
    pitch = 2 * (straight + bend - tube) - LINK_SLACK
    return [place(0, 0, -i * pitch, 90 * (i % 2), fixed=i == 0) for i in range(links)], None


def log_places(layers=4):
    """A cabin: two logs a layer, every layer across the one below, notch in notch, a gap above each."""
    reach = 5.5  # of the notches from the middle of a log
    height, notch, gap = len(LOG), 1, 0.6
    pitch = height - 2 * notch + gap
    places = []
    for layer in range(layers):
        for side in (-reach, reach):
            z = gap + height / 2 + layer * pitch
            places.append(place(side, 0, z, 90) if layer % 2 else place(0, side, z))
    return places, 0.0


def pile_places(low, high, parts=5):
    """One above the other, each turned by 90 degrees, on the ground."""
    diagonal = math.dist(low, high)
    pitch = high[2] - low[2] + PILE_GAP * diagonal
    middle = [(low[k] + high[k]) / 2 for k in (0, 1)]
    places = []
    for i in range(parts):
        turn = [(1, 0), (0, 1), (-1, 0), (0, -1)][i % 4]
        x = -(turn[0] * middle[0] - turn[1] * middle[1])
        y = -(turn[1] * middle[0] + turn[0] * middle[1])
        places.append(place(x, y, PILE_GAP * diagonal - low[2] + i * pitch, 90 * (i % 4)))
    return places, 0.0


def united(mesh, places):
    """The copies of a mesh in all places, as one mesh."""
    points, triangles = mesh
    all_points, all_triangles = [], []
    for put in places:
        first = len(all_points)
        all_points += [tuple(sum(a * x for a, x in zip(row, (*p, 1))) for row in put["matrix"][:3]) for p in points]
        all_triangles += [tuple(first + i for i in t) for t in triangles]
    return all_points, all_triangles
