"""Builds a large complex from copies of one structure on rings that are stacked along z.

A ring of m copies is divided into m slices, like a cake. Each copy lies in its own slice, at least
half the gap away from the two planes that bound the slice. The ring is as narrow as that allows.
The distance between rings is the height of the structure plus the gap. Every second ring is turned
by half a slice.
"""

import sys

from eses_tools import quiet_interrupt  # before the modules that take time to load

import collections
import math

from eses_tools.atoms import read_atoms
from eses_tools.common import NAME, Parser, at_least, complete_file, end_with, input_file, positive, require_output, say

# Each coordinate is rounded to three decimals. The rounding of two points can shorten their
# distance by 2 sqrt(3) * 0.0005 = 0.0018. The written numbers must keep the gap.
ROUNDING = 0.002

# x, y, z: lists of numbers. radius: texts.
Structure = collections.namedtuple("Structure", "x y z radius")

# centre: subtracted from the structure before it is moved and turned. radius: distance of the
# copies from the axis. layer: distance between rings.
Layout = collections.namedtuple("Layout", "copies_per_ring rings centre radius layer")


# ------------------------------------------------------------------------------------- reading


def read_structure(name, layout, program):
    structure = Structure([], [], [], [])
    for x, y, z, radius, _ in read_atoms(name, layout, program):
        structure.x.append(float(x))
        structure.y.append(float(y))
        structure.z.append(float(z))
        # Radii have only a few different values, so equal texts share one string.
        structure.radius.append(sys.intern(radius))
    return structure


# ------------------------------------------------------------------------------------ geometry


def extent(places, radii):
    return (min(p - r for p, r in zip(places, radii)), max(p + r for p, r in zip(places, radii)))


def fit_slice(x, y, radii, half_angle, distance):
    """Returns the smallest R, and the best y, at which all spheres keep `distance` from a slice's
    two planes.

    The slice opens along +x. A sphere at (R + x, y - c) keeps its distance from the upper plane if
        (R + x) sin a - (y - c) cos a >= r + distance,
    that is R + c cot a >= r' + y cot a - x with r' = (r + distance) / sin a. For the lower plane the
    signs of y and c are reversed. For each plane, one atom determines the largest bound: A for the
    upper one and B for the lower one. The smallest R satisfies both R + c cot a >= A and
    R - c cot a >= B with equality.
    """
    sine, cotangent = math.sin(half_angle), math.cos(half_angle) / math.sin(half_angle)
    above = max((r + distance) / sine + v * cotangent - u for u, v, r in zip(x, y, radii))
    below = max((r + distance) / sine - v * cotangent - u for u, v, r in zip(x, y, radii))
    return (above + below) / 2, (above - below) / (2 * cotangent)


def lay_out(structure, copies_per_ring, rings, gap):
    gap += ROUNDING
    radii = [float(text) for text in structure.radius]
    ranges = [extent(places, radii) for places in structure[:3]]
    middle = [(low + high) / 2 for low, high in ranges]
    low, high = ranges[2]
    layer = high - low + gap
    if copies_per_ring == 1:
        return Layout(1, rings, middle, 0.0, layer)
    if copies_per_ring == 2:
        # With two slices both planes are x = 0, and y is free.
        return Layout(2, rings, middle, middle[0] - ranges[0][0] + gap / 2, layer)
    radius, middle[1] = fit_slice([x - middle[0] for x in structure.x], structure.y, radii,
                                  math.pi / copies_per_ring, gap / 2)
    return Layout(copies_per_ring, rings, middle, radius, layer)


# ------------------------------------------------------------------------------------- writing


def place(structure, layout, ring, index):
    """Yields the lines of one copy."""
    step = 2 * math.pi / layout.copies_per_ring
    angle = step * (index + (ring % 2) / 2)
    cosine, sine = math.cos(angle), math.sin(angle)
    shift_x, shift_y = layout.radius - layout.centre[0], -layout.centre[1]
    shift_z = (ring - (layout.rings - 1) / 2) * layout.layer - layout.centre[2]
    for x, y, z, r in zip(*structure):
        x += shift_x
        y += shift_y
        yield f"{x * cosine - y * sine:.3f} {x * sine + y * cosine:.3f} {z + shift_z:.3f} {r}\n"


def write_complex(structure, layout, target):
    for ring in range(layout.rings):
        for index in range(layout.copies_per_ring):
            target.writelines(place(structure, layout, ring, index))
    target.flush()


# --------------------------------------------------------------------------------- command line


def parse_options():
    parser = Parser(__doc__, usage=f"{NAME} [OPTION...] FILE",
                    examples=(("1crn.xyzr -o large.xyzr", "42 copies on six rings"),
                              ("1crn.xyzr --copies 7 --rings 1 -o ring.xyzr", "one ring"),
                              ("1crn.pqr --gap 5 -o large.xyzr.gz", "5 angstrom apart")))
    parser.add_argument("structure", metavar="FILE", type=lambda text: str(input_file(text)),
                        help="xyzr or PQR file, also .gz; - is standard input")
    parser.add_argument("--copies", type=positive, default=42, metavar="N",
                        help="copies, the same number on every ring (default: 42)")
    parser.add_argument("--rings", type=positive, default=6, metavar="N",
                        help="number of rings (default: 6)")
    parser.add_argument("--gap", type=at_least(0), default=1.0, metavar="A",
                        help="minimum distance between the van der Waals spheres of different "
                             "copies, in angstrom (default: 1.0)")
    parser.add_argument("-o", "--output", default="-", metavar="FILE",
                        help="xyzr file to write, gzipped if it ends in .gz (default: -, standard "
                             "output)")
    parser.add_argument("--format", choices=("auto", "xyzr", "pqr"), default="auto",
                        help="format of the input; auto (the default) decides by the suffix")
    parser.add_program(", which reads the input")
    options = parser.parse_args()
    if options.copies % options.rings:
        parser.error(f"{options.copies} copies cannot stand evenly on {options.rings} rings")
    return options


def summary(structure, layout):
    copies, atoms = layout.copies_per_ring * layout.rings, len(structure.radius)
    return (f"{copies} copies of {atoms:,} atoms, {copies * atoms:,} in all; rings: {layout.rings} "
            f"of {layout.copies_per_ring}, radius {layout.radius:.3f}, {layout.layer:.3f} apart")


def main():
    options = parse_options()
    require_output(options.output, [options.structure])
    structure = read_structure(options.structure, options.format, options.program)
    layout = lay_out(structure, options.copies // options.rings, options.rings, options.gap)
    is_gzip = options.output.lower().endswith(".gz")
    with complete_file(options.output, compressed=is_gzip, encoding="ascii") as target:
        write_complex(structure, layout, target)
    say(summary(structure, layout))


def start():
    end_with(main)
