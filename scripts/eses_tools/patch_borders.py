"""Finds the borders between patches and atoms of the surface in a mesh, and cuts triangles at them.

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
BATCH = 200000  # divided triangles or edges at once, which bounds the memory
MAX_PARTS = 2000000  # of divided triangles, about
PIECES = 4, 16  # range of the parts of an edge of a divided triangle
HALVINGS = 5  # of an edge, to find a border on it
RINGS = 3  # of vertices around a border that know the kinds beyond it
POWER_TOLERANCE = 1e-4  # square angstrom
UNKNOWN_POWER = 1e6  # square angstrom, more than that of any sphere at the surface
MIN_SHARE = 1e-9  # of a triangle, smaller parts are left out
SAME_PLACE = 1e-4  # angstrom
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


def share_by_power(points, triangles, atoms, centers, radii):
    """Returns the index of the sphere of each vertex: that of least power among those of the vertices
    around it, as areas of atoms are shared. `atoms` has indices of spheres."""
    edges = numpy.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    edges = numpy.concatenate([edges, edges[:, ::-1]])
    atoms = atoms.copy()
    while True:
        here = edges[atoms[edges[:, 0]] != atoms[edges[:, 1]]]
        offered = power_of(points[here[:, 0]], atoms[here[:, 1]], centers, radii)
        is_less = offered < power_of(points[here[:, 0]], atoms[here[:, 0]], centers, radii) - POWER_TOLERANCE
        if not is_less.any():
            return atoms
        vertices, offered, atoms_beside = here[is_less, 0], offered[is_less], atoms[here[is_less, 1]]
        order = numpy.lexsort((-offered, vertices))  # the least power is written last
        atoms[vertices[order]] = atoms_beside[order]


def power_of(points, atoms, centers, radii):
    """Returns the powers of points with respect to spheres; that of an unknown sphere is large."""
    away = points - centers[atoms]
    return numpy.where(numpy.isfinite(radii[atoms]), row_dot(away, away) - radii[atoms]**2, UNKNOWN_POWER)


def divide_by_kind(mesh):
    """Returns points, normals and triangles of a mesh, and for each triangle the vertex of the mesh that has
    its kind of patch. Triangles between patches are divided into parts, so that also a patch is seen that
    is thinner than a triangle."""
    points, normals, triangles, kinds, atoms = parts_of(mesh)
    is_mixed = (kinds[triangles] != kinds[triangles][:, :1]).any(axis=1)
    whole, mixed = triangles[~is_mixed], triangles[is_mixed]
    pieces = int(numpy.clip(numpy.sqrt(MAX_PARTS / max(len(mixed), 1)), *PIECES))
    weights, small = grid_of(pieces)
    middles = weights[small].mean(axis=1)
    used, corner = numpy.unique(mixed, return_inverse=True)
    corner = corner.reshape(mixed.shape)
    centers, radii, probes, touched = contacts(points, normals, kinds, atoms, used)
    parts = [(points, normals, whole, whole[:, 0])]
    count = len(points)
    for part in numpy.array_split(numpy.arange(len(mixed)), max(1, len(mixed) * len(small) // BATCH)):
        here = mixed[part]
        if len(here) == 0:
            continue
        chosen = nearest_corner(numpy.einsum("mc,tcx->tmx", middles, points[here]),
                                kinds[here], probes[corner[part]], touched[corner[part]],
                                centers, radii, middles)
        base = count + len(weights) * numpy.arange(len(here))
        parts.append((numpy.einsum("mc,tcx->tmx", weights, points[here]).reshape(-1, 3),
                      numpy.einsum("mc,tcx->tmx", weights, normals[here]).reshape(-1, 3),
                      (base[:, None, None] + small).reshape(-1, 3),
                      numpy.take_along_axis(here, chosen, axis=1).ravel()))
        count += len(here) * len(weights)
    return tuple(map(numpy.concatenate, zip(*parts)))


def cut_by_atom(mesh):
    """Returns points, normals, triangles and owners of a mesh, see cut(), whose triangles are cut where the
    powers of the atoms are equal, as areas of atoms are shared.

    On solvent accessible and van der Waals surfaces the spheres meet there: the parts of a triangle get the
    normals of their spheres."""
    points, normals, triangles, kinds, atoms = parts_of(mesh)
    found, radii_found, numbers = spheres(points, normals, kinds, atoms)
    named, first, atom = numpy.unique(atoms, return_index=True, return_inverse=True)
    centers, radii = numpy.zeros((len(named), 3)), numpy.full(len(named), numpy.nan)
    index = numpy.searchsorted(named, numbers)
    centers[index], radii[index] = found, radii_found
    if not is_of_spheres(mesh):
        atom = share_by_power(points, triangles, atom, centers, radii)
    points, normals, triangles, owners = cut(points, normals, triangles, atom, lambda corners: -power_of(
        points[corners][:, :, None], atom[corners][:, None], centers, radii))
    if is_of_spheres(mesh) and len(triangles) > len(mesh.triangles):
        sphere = atom[owners]
        is_known = numpy.isfinite(radii[sphere])
        normals[is_known] = ((points - centers[sphere]) / radii[sphere][:, None])[is_known]
    return points, normals, triangles, first[atom][owners]


def is_of_spheres(mesh):
    """Whether a mesh that names atoms is a solvent accessible or van der Waals surface."""
    kinds = mesh.values.get("patch")
    return "atom" in mesh.values and (kinds is None or bool((kinds == CONVEX).all()))


def parts_of(mesh):
    """Returns points, normals, triangles, kinds of patches and atoms; spheres are convex patches."""
    kinds = mesh.values.get("patch")
    return (mesh.points.astype(float), mesh.normals.astype(float), mesh.triangles,
            numpy.full(len(mesh.points), CONVEX) if kinds is None else kinds, mesh.values["atom"])


def cut(points, normals, triangles, labels, heights_of):
    """Returns points, normals and triangles, with those whose vertices have different labels cut where the
    heights of two of their corners are equal, and for each point its owner: a vertex of the mesh that has
    the label of its triangles.

    `heights_of` returns the heights of the corners of triangles: triangle, place, corner. Between the
    places they are linear, so that the border of two corners is a line.
    """
    corner_labels = labels[triangles]
    is_mixed = (corner_labels != corner_labels[:, :1]).any(axis=1)
    if not is_mixed.any():
        return points, normals, triangles, numpy.arange(len(points))
    mixed = triangles[is_mixed]
    heights = heights_of(mixed)
    parts = [(points, normals, triangles[~is_mixed], numpy.arange(len(points)))]
    count = len(points)
    for corner in range(3):
        # A corner with the label of an earlier one has no part of its own.
        is_new = (corner_labels[is_mixed, :corner] != corner_labels[is_mixed, corner][:, None]).all(axis=1)
        shares = numpy.repeat(numpy.eye(3)[None], len(mixed), axis=0)  # polygon, place, corner of the triangle
        for other in {0, 1, 2} - {corner}:
            shares = clipped(shares, row_dot(shares, (heights[..., corner] - heights[..., other])[:, None]))
        made = count + shares.shape[1] * numpy.arange(len(mixed))[:, None]
        fans = []
        for k in range(1, shares.shape[1] - 1):
            is_kept = is_new & (numpy.abs(numpy.linalg.det(shares[:, [0, k, k + 1]])) > MIN_SHARE)
            fans.append(numpy.stack([made[:, 0], made[:, 0] + k, made[:, 0] + k + 1], axis=1)[is_kept])
        parts.append((numpy.einsum("tmc,tcx->tmx", shares, points[mixed]).reshape(-1, 3),
                      numpy.einsum("tmc,tcx->tmx", shares, normals[mixed]).reshape(-1, 3), numpy.concatenate(fans),
                      numpy.repeat(mixed[:, corner], shares.shape[1])))
        count += shares.shape[0] * shares.shape[1]
    return merged(*map(numpy.concatenate, zip(*parts)), labels)


def merged(points, normals, triangles, owners, labels):
    """Returns the points that triangles have, without repetition where labels agree."""
    used, corner = numpy.unique(triangles, return_inverse=True)
    keys = numpy.column_stack([numpy.rint(points[used] / SAME_PLACE), labels[owners[used]]]).astype("i8")
    _, first, index = numpy.unique(keys.view([("", "i8")] * 4).ravel(), return_index=True, return_inverse=True)
    kept = used[first]
    return points[kept], normals[kept], index[corner].reshape(-1, 3), owners[kept]


def clipped(polygons, values):
    """Returns convex polygons without their parts with negative values. They have a place more, and
    repeat the last one where they have fewer. Polygons without positive values become points."""
    following, values_after = numpy.roll(polygons, -1, axis=1), numpy.roll(values, -1, axis=1)
    is_kept = values >= 0
    is_crossing = (values < 0) != (values_after < 0)
    step = numpy.where(is_crossing, values / numpy.where(is_crossing, values - values_after, 1), 0)[..., None]
    places = numpy.stack([polygons, polygons + step * (following - polygons)], axis=2)
    is_there = numpy.stack([is_kept, is_crossing], axis=2)
    count = polygons.shape[1]
    places, is_there = places.reshape(len(polygons), 2 * count, -1), is_there.reshape(len(polygons), -1)
    order = numpy.argsort(~is_there, axis=1, kind="stable")[:, :count + 1]
    last = numpy.maximum(is_there.sum(axis=1) - 1, 0)[:, None]
    order = numpy.take_along_axis(order, numpy.minimum(numpy.arange(count + 1), last), axis=1)
    return numpy.take_along_axis(places, order[..., None], axis=1)
