#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the pipe junction, the shipped example: pipe_junction.stl and pipe_junction_dirty.stl.

    python3 pipe_junction.py [DIRECTORY]          (default: beside this file; needs nothing but Python)

A main pipe along x, diameter 0.04 m and length 0.15 m, carries the flow from the patch inlet (x = 0) to outlet1. Two
branches leave it at right angles: outlet2 upwards (diameter 0.03 m) and outlet3 downwards (diameter 0.025 m); their ends
are 0.115 m apart. Flat caps close all four ends; everything else is the patch wall. The dimensions are those of test
case 1 in A. Shevelko, "Octree-based Projection Mesh Generation for Complex 'Dirty' Geometries", 2006, section 5.2.

The clean model is a closed manifold of 1,956 triangles. The curve in which two pipes meet is computed exactly at the
nodes of both, and triangle edges follow it. The dirty model is the same part as a careless export leaves it, 1,911
triangles with 351 open edges: parts tessellated without regard to each other and slightly displaced, triangles that
are too small for their place, stray, repeated and flipped ones. No gap in it is wider than 0.8 mm.
"""
import math
import os
import sys

MAIN_RADIUS = 0.02
MAIN_LENGTH = 0.15
MAIN_COLUMNS = 40  # around
MAIN_ROWS = 15     # along
END_DISTANCE = 0.115  # from the end of the upper branch to that of the lower one


class Branch:
    """A pipe square to the main one, and the window of the main pipe's grid that makes room for it."""

    def __init__(self, name, radius, station, upwards, half_columns, rows):
        self.name, self.radius, self.station, self.upwards = name, radius, station, upwards
        self.half_columns, self.rows = half_columns, rows
        self.sign = 1.0 if upwards else -1.0
        self.middle_column = 0 if upwards else MAIN_COLUMNS // 2

    def crease(self, count):
        """The curve shared with the main pipe, counter-clockwise seen from outside: (angle around the main pipe, x)."""
        points = []
        for k in range(count):
            phi = 2 * math.pi * k / count
            angle = math.asin(self.radius * math.sin(phi) / MAIN_RADIUS)
            points.append((angle, self.station + self.radius * math.cos(phi)))
        return points

    def window(self):
        """Grid nodes (column, row) around the window, in the sense of the crease and starting at the same angle."""
        (low, high), half = self.rows, self.half_columns
        loop = [(c, high) for c in range(0, half)]
        loop += [(half, r) for r in range(high, low, -1)]
        loop += [(c, low) for c in range(half, -half, -1)]
        loop += [(-half, r) for r in range(low, high)]
        loop += [(c, high) for c in range(-half, 0)]
        return loop


BRANCHES = (Branch("outlet2", 0.015, 0.05, True, 6, (3, 7)),
            Branch("outlet3", 0.0125, 0.10, False, 5, (8, 12)))


# ------------------------------------------------------------------------------------------------ small geometry
def on_main(angle, x):
    """Point of the main pipe; angle 0 is the top, and grows towards +y."""
    return (x, MAIN_RADIUS * math.sin(angle), MAIN_RADIUS * math.cos(angle))


def subtract(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def shifted(triangle, by):
    return tuple((p[0] + by[0], p[1] + by[1], p[2] + by[2]) for p in triangle)


def normal(triangle):
    u, v = subtract(triangle[1], triangle[0]), subtract(triangle[2], triangle[0])
    n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    length = math.sqrt(sum(c * c for c in n))
    return tuple(c / length for c in n)


def shrunk(triangle, factor):
    """Scaled about the centre of the inscribed circle, so that the gap left open is equally wide on all sides."""
    sides = [math.dist(triangle[(k + 1) % 3], triangle[(k + 2) % 3]) for k in range(3)]
    centre = [sum(s * p[axis] for s, p in zip(sides, triangle)) / sum(sides) for axis in range(3)]
    return tuple(tuple(c + factor * (p[axis] - c) for axis, c in enumerate(centre)) for p in triangle)


def strip(inner, outer):
    """Triangles between two closed loops that start at the same place and run in the same sense: of the two triangles
    that can come next, the one with the shorter new edge."""
    triangles, i, j = [], 0, 0
    while i < len(inner) or j < len(outer):
        a, b = inner[i % len(inner)], outer[j % len(outer)]
        next_a, next_b = inner[(i + 1) % len(inner)], outer[(j + 1) % len(outer)]
        if j == len(outer) or (i < len(inner) and math.dist(next_a, b) <= math.dist(a, next_b)):
            triangles.append((a, b, next_a))
            i += 1
        else:
            triangles.append((a, b, next_b))
            j += 1
    return triangles


# ----------------------------------------------------------------------------------------------------- the parts
def main_pipe(counts):
    """The main pipe's side with its two windows; counts: segments of each branch's crease."""
    in_window = {(c % MAIN_COLUMNS, r) for b in BRANCHES
                 for c in range(b.middle_column - b.half_columns, b.middle_column + b.half_columns)
                 for r in range(*b.rows)}

    def node(column, row):
        return on_main(2 * math.pi * (column % MAIN_COLUMNS) / MAIN_COLUMNS, MAIN_LENGTH * row / MAIN_ROWS)

    triangles = []
    for column in range(MAIN_COLUMNS):
        for row in range(MAIN_ROWS):
            if (column, row) in in_window:
                continue
            a, b = node(column, row), node(column + 1, row)
            c, d = node(column + 1, row + 1), node(column, row + 1)
            triangles += [(a, c, b), (a, d, c)] if (column + row) % 2 else [(a, d, b), (b, d, c)]
    for branch, count in zip(BRANCHES, counts):
        triangles += window_strips(branch, count, node)
    return triangles


def window_strips(branch, count, node):
    """Two strips of triangles from the crease to the rim of the window."""
    turn = math.pi if branch.middle_column else 0.0
    half_angle = 2 * math.pi * branch.half_columns / MAIN_COLUMNS
    half_length = MAIN_LENGTH * (branch.rows[1] - branch.rows[0]) / MAIN_ROWS / 2
    crease, between = [], []
    for angle, x in branch.crease(count):
        along = x - branch.station
        reach = 1 / max(abs(angle) / half_angle, abs(along) / half_length)  # from the centre to the rim
        part = 1 + 0.4 * (reach - 1)
        crease.append(on_main(turn + angle, x))
        between.append(on_main(turn + part * angle, branch.station + part * along))
    rim = [node(branch.middle_column + c, r) for c, r in branch.window()]
    return strip(crease, between) + strip(between, rim)


def branch_pipe(branch, count, rings=3):
    """A branch's side from the crease to its end."""
    end = branch.sign * END_DISTANCE / 2
    loops = []
    for ring in range(rings + 1):
        loop = []
        for angle, x in branch.crease(count):
            _, y, z = on_main(angle, x)
            z *= branch.sign
            loop.append((x, branch.sign * y, z + (end - z) * ring / rings))
        loops.append(loop)
    triangles = []
    for low, high in zip(loops, loops[1:]):
        for k in range(count):
            a, b, c, d = low[k], low[(k + 1) % count], high[(k + 1) % count], high[k]
            triangles += [(a, b, c), (a, c, d)]
    return triangles


def cap(loop):
    """A flat end: the polygon's triangles in a zigzag, none of them at a centre."""
    triangles, low, high = [], 0, len(loop) - 1
    while high - low > 1:
        triangles.append((loop[low], loop[low + 1], loop[high]))
        low += 1
        if high - low > 1:
            triangles.append((loop[low], loop[high - 1], loop[high]))
            high -= 1
    return triangles


def main_end(count, x, outwards, radius=MAIN_RADIUS):
    loop = [(x, radius * math.sin(2 * math.pi * k / count), radius * math.cos(2 * math.pi * k / count))
            for k in range(count)]
    return cap(loop[::-1] if outwards > 0 else loop)


def branch_end(branch, count, radius=None):
    radius = radius or branch.radius
    loop = []
    for k in range(count):
        phi = 2 * math.pi * k / count
        loop.append((branch.station + radius * math.cos(phi), branch.sign * radius * math.sin(phi),
                     branch.sign * END_DISTANCE / 2))
    return cap(loop)


# --------------------------------------------------------------------------------------------------- the models
def clean_model():
    """Patch name -> triangles, normals outwards."""
    upper, lower = BRANCHES
    return {
        "inlet": main_end(MAIN_COLUMNS, 0.0, -1),
        "wall": main_pipe((40, 40)) + branch_pipe(upper, 40) + branch_pipe(lower, 40),
        "outlet1": main_end(MAIN_COLUMNS, MAIN_LENGTH, +1),
        "outlet2": branch_end(upper, 40),
        "outlet3": branch_end(lower, 40),
    }


def dirty_model():
    """The clean model as five parts that do not fit, with single triangles spoilt."""
    upper, lower = BRANCHES
    side = main_pipe((40, 40))
    # Rows next to the ends are left alone, and chosen triangles share no corner with each other.
    for k in range(8):
        index = 60 + 112 * k
        side[index] = shrunk(side[index], 0.7)
    for k in range(12):
        index = 33 + 79 * k
        side[index] = side[index][::-1]
    stray = [shifted(side[index], [3e-4 * c for c in normal(side[index])]) for index in (101, 413, 727)]
    repeated = [side[233], side[611]]
    displaced = (2e-4, 3e-4, 2e-4)
    return {
        "inlet": [shifted(t, (5e-4, 0, 2e-4)) for t in main_end(30, 0.0, -1)],
        "wall": side + stray + repeated + [shifted(t, displaced) for t in branch_pipe(upper, 36)] +
        branch_pipe(lower, 40),
        "outlet1": main_end(34, MAIN_LENGTH, +1, MAIN_RADIUS - 4e-4),
        "outlet2": [shifted(t, displaced) for t in branch_end(upper, 36)],
        "outlet3": [shifted(t, (0, 2e-4, -4e-4)) for t in branch_end(lower, 34)],
    }


def write_stl(path, model):
    """ASCII STL, one solid a patch, coordinates to a tenth of a micrometre."""
    with open(path, "w", encoding="ascii") as out:
        for name, triangles in model.items():
            out.write(f"solid {name}\n")
            for triangle in triangles:
                out.write("facet normal %.4g %.4g %.4g\nouter loop\n" % normal(triangle))
                for point in triangle:
                    out.write("vertex %s %s %s\n" % tuple(f"{c + 0.0:.7f}".replace("-0.0000000", "0") for c in point))
                out.write("endloop\nendfacet\n")
            out.write(f"endsolid {name}\n")


def write_models(directory):
    write_stl(os.path.join(directory, "pipe_junction.stl"), clean_model())
    write_stl(os.path.join(directory, "pipe_junction_dirty.stl"), dirty_model())


if __name__ == "__main__":
    write_models(sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(os.path.abspath(__file__)))
