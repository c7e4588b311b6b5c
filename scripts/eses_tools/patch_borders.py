"""Finds the borders between patches of the surface in a mesh, and divides triangles at them.

A vertex names its kind of patch and its first adjacent atom. Its probe is at x + p n. The spheres
and the probe radius p follow from the vertices: on a convex patch x = a + r n, and elsewhere the
probe touches the sphere of the first atom. So each point of a triangle between patches can be given
the patch of the nearest place where the probe may be, as in doc/algorithm.md.
"""

import itertools

import numpy

CONVEX, SADDLE, CONCAVE = 1, 2, 3
TOLERANCE = 1e-3  # angstrom; normals of PLY files have single precision
MIN_GAP = 0.02  # angstrom; nearer to a contact circle the probe radius is inexact
BATCH = 200000  # divided triangles at once, which bounds the memory
HALVINGS = 5  # of an edge, to find a border on it
RINGS = 3  # of vertices around a border that know the kinds beyond it
CELL = 4.0  # angstrom; side of the cells in which spheres are looked up


def row_dot(a, b):
    return numpy.einsum("...i,...i->...", a, b)


def spheres(points, normals, kinds, atoms):
    """Returns centres, radii and numbers of the atoms that have enough convex vertices, by least
    squares of x = a + r n."""
    chosen = kinds == CONVEX
    numbers, atom = numpy.unique(atoms[chosen], return_inverse=True)
    points, normals = points[chosen], normals[chosen]
    counts = numpy.bincount(atom)[:, None]

    def mean(values):
        return numpy.stack([numpy.bincount(atom, column) for column in values.T], axis=1) / counts

    point, normal = mean(points), mean(normals)
    apart = normals - normal[atom]
    spread = numpy.bincount(atom, row_dot(apart, apart))
    is_known = spread > 1e-4
    radii = numpy.bincount(atom, row_dot(points - point[atom], apart)) / numpy.where(is_known,
                                                                                   spread, 1)
    return (point - radii[:, None] * normal)[is_known], radii[is_known], numbers[is_known]


def probe_radius(places, normals, radii):
    """Returns the radius p of the probe from places on saddle and concave patches, relative to the
    centre of an adjacent sphere of radius r, or None if there are too few.

    The probe touches this sphere: |x + p n| = r + p, so p = (x x - r r) / (2 (r - n x)).
    """
    gaps = radii - row_dot(normals, places)
    is_far = gaps > MIN_GAP
    if not is_far.any():
        return None
    values = (row_dot(places, places) - radii**2)[is_far] / (2 * gaps[is_far])
    return float(numpy.median(values))


def touching(probes, centers, radii):
    """Returns for each probe the spheres on whose surface it lies, at most three; -1 for none."""
    found = numpy.full((len(probes), 3), -1)
    reach = int(numpy.ceil((radii.max() + TOLERANCE) / CELL)) if len(radii) else 0
    cells = {}
    for number, cell in enumerate(map(tuple, numpy.floor(centers / CELL).astype(int))):
        cells.setdefault(cell, []).append(number)
    places = numpy.floor(probes / CELL).astype(int)
    order = numpy.lexsort(places.T)
    starts = numpy.flatnonzero(numpy.any(numpy.diff(places[order], axis=0), axis=1)) + 1
    steps = list(itertools.product(range(-reach, reach + 1), repeat=3))
    for group in numpy.split(order, starts) if len(order) else []:
        x, y, z = places[group[0]]
        near = [n for i, j, k in steps for n in cells.get((x + i, y + j, z + k), ())]
        if not near:
            continue
        near = numpy.array(near)
        gaps = numpy.abs(numpy.linalg.norm(probes[group, None] - centers[near], axis=2)
                         - radii[near])
        best = numpy.argsort(gaps, axis=1)[:, :3]
        close = numpy.take_along_axis(gaps, best, axis=1) < TOLERANCE
        found[group, :best.shape[1]] = numpy.where(close, near[best], -1)
    return found


def grid_of(pieces):
    """Returns barycentric coordinates of the points and the triangles of a divided triangle."""
    numbers, corners = {}, []
    for i in range(pieces + 1):
        for j in range(pieces + 1 - i):
            numbers[i, j] = len(corners)
            corners.append((pieces - i - j, i, j))
    small = []
    for i, j in numbers:
        if i + j < pieces:
            small.append((numbers[i, j], numbers[i + 1, j], numbers[i, j + 1]))
        if i + j < pieces - 1:
            small.append((numbers[i + 1, j], numbers[i + 1, j + 1], numbers[i, j + 1]))
    return numpy.array(corners) / pieces, numpy.array(small)


def nearest_corner(places, kind, probe, touched, centers, radii, weights):
    """Returns the corner of its triangle, or the end of its edge, to whose patch each place belongs.

    places: triangle, place, xyz. kind, probe and touched are of the triangles' corners. The patch
    of each corner gives a position of the probe for the place: on the sphere of its atom, on the circle of
    both, or the probe of a concave patch. Positions inside another sphere are impossible. The
    nearest one decides, or the nearest corner if none is possible.
    """
    spheres_near = touched.reshape(len(touched), -1)
    corners = kind.shape[1]
    distance = numpy.full((*places.shape[:2], corners), numpy.inf)
    for corner in range(corners):
        first, second = touched[:, corner, 0], touched[:, corner, 1]
        a, b = centers[first][:, None], centers[second][:, None]
        toward = places - a
        on_sphere = a + toward * (radii[first][:, None]
                                  / numpy.linalg.norm(toward, axis=2))[..., None]
        axis = b - a
        length = numpy.linalg.norm(axis, axis=2)[..., None]
        axis = axis / numpy.maximum(length, 1e-9)
        along = (length**2 + (radii[first]**2 - radii[second]**2)[:, None, None]) / (
            2 * numpy.maximum(length, 1e-9))
        aside = toward - row_dot(toward, axis)[..., None] * axis
        ring = numpy.sqrt(numpy.maximum(radii[first][:, None, None]**2 - along**2, 0))
        on_circle = a + along * axis + aside * (
            ring / numpy.maximum(numpy.linalg.norm(aside, axis=2)[..., None], 1e-9))
        which = kind[:, corner, None, None]
        position = numpy.where(which == CONVEX, on_sphere,
                               numpy.where(which == SADDLE, on_circle, probe[:, corner][:, None]))
        is_known = ((which[..., 0] == CONCAVE) | ((first >= 0)[:, None] & (
            (which[..., 0] == CONVEX) | (second >= 0)[:, None])))
        for number in spheres_near.T:
            other = numpy.linalg.norm(position - centers[number][:, None], axis=2)
            is_known = is_known & ((number < 0)[:, None]
                                   | (other > (radii[number] - TOLERANCE)[:, None]))
        distance[..., corner] = numpy.where(
            is_known, numpy.linalg.norm(position - places, axis=2), numpy.inf)
    chosen = numpy.argmin(distance, axis=2)
    return numpy.where(numpy.isfinite(distance.min(axis=2)), chosen, numpy.argmax(weights, axis=-1))


def index_of(values, ordered):
    """Returns the index of each value in an ordered array, or -1."""
    at = numpy.minimum(numpy.searchsorted(ordered, values), len(ordered) - 1)
    return numpy.where(ordered[at] == values, at, -1)


def contacts(points, normals, kinds, atoms, used):
    """Returns centres and radii of the SAS spheres, and the probes of the `used` vertices with the
    spheres that they touch."""
    centers, radii, numbers = spheres(points, normals, kinds, atoms)
    if len(numbers) == 0:  # no borders can be found
        centers, radii, numbers = numpy.zeros((1, 3)), numpy.zeros(1), numpy.full(1, -1)
    own = index_of(atoms, numbers)
    is_bent = (kinds != CONVEX) & (own >= 0)
    probe = probe_radius(points[is_bent] - centers[own[is_bent]], normals[is_bent],
                         radii[own[is_bent]]) or 0.0
    radii = radii + probe
    probes = points[used] + probe * normals[used]
    touched = touching(probes, centers, radii)
    is_convex = kinds[used] == CONVEX
    touched[is_convex] = -1
    touched[is_convex, 0] = own[used[is_convex]]
    return centers, radii, probes, touched


def border_heights(points, normals, triangles, kinds, atoms):
    """Returns two bytes for each vertex: the heights at it of the next kind of patch (1, 2, 3, 1) and
    of the one after that. Its own kind has 255, and a kind that is not near 0. If heights are
    interpolated in the triangles, two kinds are equally high where their border meets an edge. Heights
    around a border fall with the distance: one that ends in a thin triangle would show as a line."""
    all_edges = numpy.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    is_mixed = kinds[all_edges[:, 0]] != kinds[all_edges[:, 1]]
    edges = numpy.unique(numpy.sort(all_edges[is_mixed], axis=1), axis=0)
    heights = numpy.zeros((len(points), 2), "u1")
    if len(edges) == 0:
        return heights
    used, end = numpy.unique(edges, return_inverse=True)
    end = end.reshape(edges.shape)
    centers, radii, probes, touched = contacts(points, normals, kinds, atoms, used)
    shares = numpy.empty(len(edges))  # of each edge, from its first end to the border
    for part in numpy.array_split(numpy.arange(len(edges)), len(edges) // BATCH + 1):
        here, ends = edges[part], end[part]
        low, high = numpy.zeros(len(part)), numpy.ones(len(part))
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            weights = numpy.stack([1 - middle, middle], axis=1)[:, None]
            is_first = nearest_corner(numpy.einsum("emc,ecx->emx", weights, points[here]), kinds[here],
                                      probes[ends], touched[ends], centers, radii, weights)[:, 0] == 0
            low, high = numpy.where(is_first, middle, low), numpy.where(is_first, high, middle)
        shares[part] = (low + high) / 2
    lengths = edge_lengths(points, edges)
    nearest = numpy.full((len(points), 4), numpy.inf)  # distance from the border to each kind
    for vertex, other, share in ((edges[:, 0], edges[:, 1], shares), (edges[:, 1], edges[:, 0], 1 - shares)):
        numpy.minimum.at(nearest, (vertex, kinds[other]), share * lengths)
    own = numpy.arange(len(points)), kinds
    for _ in range(RINGS - 1):
        is_near = numpy.isfinite(nearest).any(axis=1)
        around = all_edges[is_near[all_edges].any(axis=1)]
        given = nearest[around] + edge_lengths(points, around)[:, None, None]
        for vertex, other in ((0, 1), (1, 0)):
            numpy.minimum.at(nearest, around[:, vertex], given[:, other])
        nearest[own] = numpy.inf
    next_kinds = 1 + (kinds[:, None] + numpy.arange(2)) % 3
    distances = numpy.take_along_axis(nearest, next_kinds, axis=1)
    is_near = numpy.isfinite(distances)
    heights[is_near] = numpy.clip(numpy.rint(255 * (1 - distances[is_near] / lengths.max())), 1, 254)
    return heights


def edge_lengths(points, edges):
    return numpy.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)


def divide(points, normals, triangles, kinds, atoms, colors, pieces):
    """Returns points, normals, triangles and the colour of each triangle, with the triangles at
    borders of colours divided into `pieces` squared parts."""
    corner_colors = colors[triangles]
    is_mixed = (corner_colors != corner_colors[:, :1]).any(axis=(1, 2))
    whole, mixed = triangles[~is_mixed], triangles[is_mixed]
    weights, small = grid_of(pieces)
    middles = weights[small].mean(axis=1)
    used, corner = numpy.unique(mixed, return_inverse=True)
    corner = corner.reshape(mixed.shape)
    centers, radii, probes, touched = contacts(points, normals, kinds, atoms, used)
    all_points, all_normals = [points], [normals]
    all_triangles, all_colors = [whole], [colors[whole[:, 0]]]
    count = len(points)
    batches = max(1, len(mixed) * len(small) // BATCH)
    for part in numpy.array_split(numpy.arange(len(mixed)), batches):
        here = mixed[part]
        if len(here) == 0:
            continue
        chosen = nearest_corner(numpy.einsum("mc,tcx->tmx", middles, points[here]),
                                kinds[here], probes[corner[part]], touched[corner[part]],
                                centers, radii, middles)
        all_points.append(numpy.einsum("mc,tcx->tmx", weights, points[here]).reshape(-1, 3))
        all_normals.append(numpy.einsum("mc,tcx->tmx", weights, normals[here]).reshape(-1, 3))
        base = count + len(weights) * numpy.arange(len(here))
        all_triangles.append((base[:, None, None] + small).reshape(-1, 3))
        all_colors.append(numpy.take_along_axis(colors[here], chosen[..., None], axis=1)
                          .reshape(-1, 3))
        count += len(here) * len(weights)
    return tuple(map(numpy.concatenate, (all_points, all_normals, all_triangles, all_colors)))
