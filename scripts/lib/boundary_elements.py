"""Solvation energies from boundary elements, without a dense matrix.

Galerkin's method with linear elements on flat or curved triangles. fmm3dpy sums over all pairs of
integration points by the fast multipole method (L. Greengard, V. Rokhlin, Acta Numerica 6 (1997),
229-269, doi:10.1017/S0962492900002725). In its version 2.1 the kernel is 1 / (4 pi r). Triangles
close to a point are integrated over smaller and smaller parts, and a sparse matrix has the
corrections.
"""

import math

import fmm3dpy
import numba
import numpy
from scipy.sparse import csr_array
from scipy.sparse.linalg import LinearOperator, gmres
from scipy.spatial import cKDTree

from eses_tools.common import Failed

# Barycentric coordinates and weights of the rule of degree 4 with six points: D. A. Dunavant, Int.
# J. Numer. Methods Eng. 21 (1985), 1129-1148, doi:10.1002/nme.1620210612.
A, B = 0.445948490915965, 0.091576213509771
RULE = numpy.array([[1 - 2 * A, A, A], [A, 1 - 2 * A, A], [A, A, 1 - 2 * A],
                    [1 - 2 * B, B, B], [B, 1 - 2 * B, B], [B, B, 1 - 2 * B]])
WEIGHTS = numpy.array([0.223381589678011] * 3 + [0.109951743655322] * 3) / 2  # sum: area of (b, c)
COUNT = len(WEIGHTS)

CUSP_COSINE = 0.5  # of the angle between two normals, see doc/meshes.md
NEAR = 1.5  # a part of a triangle is close to points within this multiple of its longest edge
MIN_PART = 2.0**-7  # edge of the smallest parts, as a fraction of the edge of the triangle
MAX_PARTS = 22  # that wait for their integration: three of each size, and one more of the smallest
BATCH = 10000  # triangles whose corrections are computed together
SUM_PRECISION = 1e-3  # of the fast multipole method
TOLERANCE = 1e-5  # of the residual of GMRES


# ------------------------------------------------------------------------------------- geometry


def surface_polynomials(mesh, is_curved):
    """Returns the coefficients of 1, b, c, b^2, bc and c^2 in the points of each triangle, where b
    and c are barycentric coordinates.

    Curved edges are parabolas. Their middle is that of the cubic which is perpendicular to the
    normals at both ends: A. Vlachos et al., Proc. Symp. Interactive 3D Graphics (2001), 159-166,
    doi:10.1145/364338.364387. Edges across cusps are straight.
    """
    normals = mesh.normals / numpy.linalg.norm(mesh.normals, axis=1, keepdims=True)

    def bulge(start, end):
        """Returns four times the vector from the middle of a chord to that of its edge."""
        chord = mesh.points[end] - mesh.points[start]
        heights = [(chord * normals[corner]).sum(-1, keepdims=True) for corner in (start, end)]
        is_smooth = (normals[start] * normals[end]).sum(-1, keepdims=True) >= CUSP_COSINE
        return numpy.where(is_smooth & is_curved,
                           (heights[1] * normals[end] - heights[0] * normals[start]) / 2, 0.0)

    corners = mesh.triangles.T
    origin, b_corner, c_corner = mesh.points[corners]
    ab, bc, ca = bulge(corners, numpy.roll(corners, -1, axis=0))
    # The bulges are multiplied by ab, bc and ca, and a = 1 - b - c.
    return numpy.stack([origin, b_corner - origin + ab, c_corner - origin + ca,
                        -ab, bc - ab - ca, -ca], axis=1)


@numba.njit(fastmath=True)
def point_at(p, b, c):
    """Returns a point of the triangle with these coefficients."""
    x = p[0, 0] + b * (p[1, 0] + b * p[3, 0] + c * p[4, 0]) + c * (p[2, 0] + c * p[5, 0])
    y = p[0, 1] + b * (p[1, 1] + b * p[3, 1] + c * p[4, 1]) + c * (p[2, 1] + c * p[5, 1])
    z = p[0, 2] + b * (p[1, 2] + b * p[3, 2] + c * p[4, 2]) + c * (p[2, 2] + c * p[5, 2])
    return x, y, z


@numba.njit(fastmath=True)
def normal_at(p, b, c):
    """Returns the normal there. Its length is the area for each area of the plane (b, c)."""
    bx = p[1, 0] + 2 * b * p[3, 0] + c * p[4, 0]
    by = p[1, 1] + 2 * b * p[3, 1] + c * p[4, 1]
    bz = p[1, 2] + 2 * b * p[3, 2] + c * p[4, 2]
    cx = p[2, 0] + b * p[4, 0] + 2 * c * p[5, 0]
    cy = p[2, 1] + b * p[4, 1] + 2 * c * p[5, 1]
    cz = p[2, 2] + b * p[4, 2] + 2 * c * p[5, 2]
    return by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx


@numba.njit
def integration_points(polynomials):
    """Returns the points of RULE on all triangles, and the normals there times the weights."""
    points = numpy.empty((len(polynomials) * COUNT, 3))
    normals = numpy.empty_like(points)
    for i in range(len(points)):
        p, (_, b, c) = polynomials[i // COUNT], RULE[i % COUNT]
        points[i] = point_at(p, b, c)
        x, y, z = normal_at(p, b, c)
        normals[i] = x * WEIGHTS[i % COUNT], y * WEIGHTS[i % COUNT], z * WEIGHTS[i % COUNT]
    return points, normals


# ------------------------------------------------------------------------- integrals of the kernel


@numba.njit(fastmath=True)
def kernel(p, b, c, target):
    """Returns the derivative of 1 / (4 pi distance from the target) along the normal."""
    x, y, z = point_at(p, b, c)
    normal_x, normal_y, normal_z = normal_at(p, b, c)
    x, y, z = target[0] - x, target[1] - y, target[2] - z
    square = x * x + y * y + z * z
    return ((x * normal_x + y * normal_y + z * normal_z)
            / (4 * math.pi * square * math.sqrt(square)))


@numba.njit(fastmath=True)
def integrate(p, b, c, edge, target, factor, skipped, sums):
    """Adds the integrals of the kernel times each linear element over a part of a triangle. The
    part has the corners (b, c), (b + edge, c) and (b, c + edge)."""
    for i in range(COUNT):
        if i != skipped:
            at_b, at_c = b + edge * RULE[i, 1], c + edge * RULE[i, 2]
            value = factor * edge**2 * WEIGHTS[i] * kernel(p, at_b, at_c, target)
            sums[0] += value * (1 - at_b - at_c)
            sums[1] += value * at_b
            sums[2] += value * at_c


@numba.njit(fastmath=True)
def integrate_near(p, length, target, parts, sums):
    """Adds the integrals over a triangle, divided into four parts until these are not close to the
    target. `length`: of the longest edge. `parts`: memory for those not yet integrated."""
    parts[0] = 0.0, 0.0, 1.0
    count = 1
    while count > 0:
        count -= 1
        b, c, edge = parts[count]
        x, y, z = point_at(p, b + edge / 3, c + edge / 3)
        square = (target[0] - x)**2 + (target[1] - y)**2 + (target[2] - z)**2
        if square > (NEAR * length * edge)**2 or abs(edge) <= MIN_PART:
            integrate(p, b, c, edge, target, 1.0, -1, sums)
        else:
            half = edge / 2
            parts[count] = b, c, half
            parts[count + 1] = b + half, c, half
            parts[count + 2] = b, c + half, half
            parts[count + 3] = b + half, c + half, -half
            count += 4


@numba.njit(parallel=True)
def near_corrections(polynomials, lengths, points, first, starts, targets):
    """Returns the integrals over triangles at their close points, minus those by RULE alone.

    Triangle `first + i` is close to the points targets[starts[i]:starts[i + 1]].
    """
    corrections = numpy.zeros((len(targets), 3))
    for i in numba.prange(len(starts) - 1):
        parts = numpy.empty((MAX_PARTS, 3))
        p = polynomials[first + i]
        for pair in range(starts[i], starts[i + 1]):
            target = points[targets[pair]]
            # A point has no contribution to its own sum.
            same_point = targets[pair] - (first + i) * COUNT
            integrate(p, 0.0, 0.0, 1.0, target, -1.0, same_point, corrections[pair])
            integrate_near(p, lengths[first + i], target, parts, corrections[pair])
    return corrections


class Surface:
    """Integration points on a mesh, and integrals over its surface."""

    def __init__(self, mesh, is_curved):
        self.mesh = mesh
        self.polynomials = surface_polynomials(mesh, is_curved)
        self.points, self.normals = integration_points(self.polynomials)
        self.areas = numpy.linalg.norm(self.normals, axis=1)
        # from values at the vertices to values at the points
        self.interpolation = csr_array(
            (numpy.tile(RULE.ravel(), len(mesh.triangles)),
             numpy.repeat(mesh.triangles, COUNT, axis=0).ravel(),
             numpy.arange(0, RULE.size * len(mesh.triangles) + 1, 3)))

    def test(self, values):
        """Returns the integrals of a function times the linear element of each vertex."""
        return self.interpolation.T @ (self.areas * values)

    def double_layer(self):
        """Returns the function that computes the integrals of a double-layer potential times each
        linear element, from values at the vertices."""
        near = self._near_matrix()

        def potential(values):
            strengths = (self.interpolation @ values)[:, None] * self.normals
            far = fmm3dpy.lfmm3d(eps=SUM_PRECISION, sources=self.points.T, dipvec=strengths.T, pg=1)
            return far.pot + near @ values

        # The potential of a constant 1 is -1/2 on a closed surface. The errors of the integrals
        # close to a point nearly cancel in the differences from its own value.
        error = potential(numpy.ones(len(self.mesh.points))) + 0.5
        return lambda values: self.test(potential(values) - error * (self.interpolation @ values))

    def _near_matrix(self):
        corners = self.mesh.points[self.mesh.triangles]
        lengths = numpy.linalg.norm(corners - numpy.roll(corners, 1, axis=1), axis=2).max(1)
        middles = self.polynomials.transpose(0, 2, 1) @ [1, 1 / 3, 1 / 3, 1 / 9, 1 / 9, 1 / 9]
        tree = cKDTree(self.points)
        total = csr_array(self.interpolation.shape)
        for first in range(0, len(lengths), BATCH):
            batch = slice(first, first + BATCH)
            found = tree.query_ball_point(middles[batch], NEAR * lengths[batch])
            counts = [len(targets) for targets in found]
            targets = numpy.concatenate(found).astype(int)
            values = near_corrections(self.polynomials, lengths, self.points, first,
                                      numpy.append(0, numpy.cumsum(counts)), targets)
            columns = numpy.repeat(self.mesh.triangles[batch], counts, axis=0)
            total += csr_array((values.ravel(), (numpy.repeat(targets, 3), columns.ravel())),
                               shape=total.shape)
        return total


# --------------------------------------------------------------------------------------- energy


def solve(surface, charges, inner, outer):
    """Returns the solvation energy where the Coulomb energy of two charges is their product divided
    by their distance, and the number of iterations. `inner` and `outer` are the dielectrics.

    The potential phi on the surface obeys (e1 + e2) / 2 phi + (e1 - e2) K phi = G q, where K is
    the double layer operator and G q is the Coulomb potential of the charges times e1. The reaction
    potential at the charges is (e2 - e1) / e1 times the double layer potential of phi. The equation
    follows from A. H. Juffer et al., J. Comput. Phys. 97 (1991), 144-171,
    doi:10.1016/0021-9991(91)90043-K, without ions.
    """
    coulomb = fmm3dpy.lfmm3d(eps=TOLERANCE, sources=numpy.transpose(charges.positions),
                             charges=numpy.array(charges.values), targets=surface.points.T, pgt=2)
    scale = surface.test(numpy.ones(len(surface.points))) * (inner + outer) / 2
    double_layer, shape = surface.double_layer(), 2 * scale.shape

    def equation(phi):
        return ((inner + outer) / 2 * surface.test(surface.interpolation @ phi)
                + (inner - outer) * double_layer(phi))

    iterations = []
    phi, failed = gmres(LinearOperator(shape, matvec=equation), surface.test(coulomb.pottarg),
                        rtol=TOLERANCE, restart=200, maxiter=1,
                        M=LinearOperator(shape, matvec=lambda x: x / scale),
                        callback=iterations.append, callback_type="pr_norm")
    if failed:
        raise Failed("GMRES does not converge")
    # The kernel of the double layer potential is the derivative of 1 / (4 pi r).
    flux = (surface.normals * coulomb.gradtarg.T).sum(1)
    energy = 2 * math.pi * (outer - inner) / inner * float(flux @ (surface.interpolation @ phi))
    return energy, len(iterations)
