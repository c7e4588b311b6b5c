"""Reads maps in the format OpenDX, such as potentials of APBS, and takes values from them."""

import gzip
import itertools

import numpy

from eses_tools.common import Failed


class Map:
    """Values on a Cartesian grid: `origin` and `spacing` are in angstrom."""

    def __init__(self, path, origin, spacing, values):
        self.path, self.origin, self.spacing, self.values = path, origin, spacing, values

    def at(self, places):
        """Returns values at places, by linear interpolation. Throws Failed if a place is outside."""
        steps = (places - self.origin) / self.spacing
        last = numpy.array(self.values.shape) - 1
        outside = ((steps < 0) | (steps > last)).any(axis=1)
        if outside.any():
            where = " ".join(f"{value:.2f}" for value in places[outside][0])
            raise Failed(f"{self.path}: {outside.sum()} of {len(places)} places on the surface are "
                         f"outside the map, the first at {where}")
        cells = numpy.minimum(steps.astype(int), last - 1)
        shares = steps - cells
        result = numpy.zeros(len(places))
        for corner in itertools.product((0, 1), repeat=3):
            weights = numpy.where(corner, shares, 1 - shares).prod(axis=1)
            result += weights * self.values[tuple((cells + corner).T)]
        return result


def read_map(path):
    """Reads a .dx or .dx.gz file. Throws Failed if it is not a map on a Cartesian grid."""
    opened = gzip.open if path.suffix.lower() == ".gz" else open
    shape, origin, spacing = None, None, []
    try:
        with opened(path, "rt", encoding="ascii", errors="replace") as source:
            for line in source:
                words = line.split()
                if "gridpositions" in words:
                    shape = tuple(map(int, words[-3:]))
                elif words[:1] == ["origin"]:
                    origin = numpy.array(words[1:4], float)
                elif words[:1] == ["delta"]:
                    spacing.append(list(map(float, words[1:4])))
                elif words[-2:] == ["data", "follows"]:
                    break
            count = int(numpy.prod(shape))
            words = itertools.chain.from_iterable(map(str.split, source))
            values = numpy.fromiter(map(float, itertools.islice(words, count)), float, count)
        axes = numpy.array(spacing)
        if (axes != numpy.diag(axes.diagonal())).any() or min(shape) < 2 or (
                not numpy.isfinite(values).all()):
            raise ValueError
    except (EOFError, TypeError, ValueError):
        raise Failed(f"{path}: not an OpenDX map on a Cartesian grid") from None
    return Map(path, origin, axes.diagonal(), values.reshape(shape))


def potential_at(field, points, normals, offset):
    """Returns the potential `offset` angstrom outside of the surface, along its normals."""
    return field.at(numpy.asarray(points, float) + offset * numpy.asarray(normals, float))
