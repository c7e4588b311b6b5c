"""Reads maps in the format OpenDX, such as potentials of APBS, and takes values from them."""

import gzip
import itertools

import numpy

from eses_tools.common import Failed, gzip_errors


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


def read_header(lines, path):
    """Reads the lines before the values. Returns the points along the axes, origin and steps."""
    shape, origin, steps = None, None, []
    for line in lines:
        words = line.split()
        if "gridpositions" in words:
            shape = tuple(map(int, words[-3:]))
        elif words[:1] == ["origin"]:
            origin = numpy.array(words[1:4], float)
        elif words[:1] == ["delta"]:
            steps.append(list(map(float, words[1:4])))
        elif words[-2:] == ["data", "follows"]:
            values = dict(zip(words, words[1:]))
            if int(values.get("rank", 0)) != 0:
                raise Failed(f"{path}: the map has vectors; expected a map of a potential, with rank 0")
            if "items" in values and int(values["items"]) != numpy.prod(shape):
                raise Failed(f"{path}: {values['items']} items, but {numpy.prod(shape)} points")
            break
    return shape, origin, numpy.array(steps)


def require_end(line, path):
    """Throws Failed if a line after the values begins with a number."""
    try:
        float(line.split()[0])
    except (IndexError, ValueError):
        return
    raise Failed(f"{path}: more values than points")


def read_values(lines, count, path):
    """Reads a value for each point."""
    values, place = numpy.empty(count), 0
    for line in lines:
        if place == count:
            require_end(line, path)
            if line.strip():
                break
            continue
        words = line.split()
        if place + len(words) > count:
            require_end(words[count - place], path)
        found = words[:count - place]
        values[place:place + len(found)] = found
        place += len(found)
    if place < count:
        raise Failed(f"{path}: fewer values than points")
    return values


def read_map(path):
    """Reads a .dx or .dx.gz file. Throws Failed if it is not a map on a Cartesian grid."""
    opened = gzip.open if path.suffix.lower() == ".gz" else open
    try:
        with gzip_errors(path), opened(path, "rt", encoding="ascii", errors="replace") as lines:
            shape, origin, axes = read_header(lines, path)
            values = read_values(lines, int(numpy.prod(shape)), path)
        if (axes != numpy.diag(axes.diagonal())).any() or min(shape) < 2 or (
                not numpy.isfinite(values).all()):
            raise ValueError
    except (TypeError, ValueError):
        raise Failed(f"{path}: not an OpenDX map on a Cartesian grid") from None
    return Map(path, origin, axes.diagonal(), values.reshape(shape))


def potential_at(field, points, normals, offset):
    """Returns the potential `offset` angstrom outside of the surface, along its normals."""
    return field.at(numpy.asarray(points, float) + offset * numpy.asarray(normals, float))
