#pragma once
/// @file
/// Totals of a computation.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "eses/cavities.hpp"

namespace eses {

/// Times, in seconds.
struct PhaseSeconds {
  /// Wall-clock time of patches, classification, intersection and text of all blocks.
  double blocks = 0;
  double patches = 0;    ///< Neighbours, arcs and probe placements, summed over threads.
  double classify = 0;   ///< Classification of points, summed over threads.
  double intersect = 0;  ///< Intersection of edges, summed over threads.
  double output = 0;     ///< Text and writing, summed over threads.
  double verify = 0;     ///< Wall-clock time of the verification.
  double total = 0;      ///< Wall-clock time of the whole computation.
};

/// Result of a check of random points and edges against the definition of the surface.
struct Verification {
  /// Number of checked points. Smaller than requested if there are fewer points.
  std::int64_t points = 0;
  /// Number of checked edges. Smaller than requested if there are fewer crossings.
  std::int64_t edges = 0;
  std::vector<std::string> faults;  ///< One line for each fault, with the point or edge.
};

/// Number of elements of a mesh.
struct MeshCounts {
  std::uint64_t vertices = 0;   ///< Number of vertices.
  std::uint64_t triangles = 0;  ///< Number of triangles.
};

/// Angles of the triangles of a mesh with MeshOptions::quality.
struct MeshQuality {
  double smallest_angle = 0;             ///< Smallest angle of all triangles, in degrees.
  std::uint64_t below_20 = 0;            ///< Number of triangles with an angle below 20 degrees.
  std::uint64_t below_5 = 0;             ///< Number of triangles with an angle below 5 degrees.
  std::uint64_t at_cusps = 0;            ///< Number of triangles at cusps: normals of the surface
                                         ///< at two corners form an angle of more than 60 degrees.
  std::uint64_t below_5_near_cusps = 0;  ///< Number of triangles among `below_5` that are at cusps
                                         ///< or have a common corner with a triangle at a cusp.
};

/// Totals of the points and edges that were computed. With MeshOptions::component, the inside
/// points are those in the void of the cavity.
///
/// With the spacing h, the outward unit normal n of a crossing on an edge along `axis`, and sums
/// over all crossings and points, the estimates follow Liu et al. (J. Comput. Chem. 38, 446,
/// 2017, doi:10.1002/jcc.24682):
///
///     area   = h^2 * sum |n[axis]|
///     volume = h^3 * (inside points without a crossing + 1/2 * points that end a crossed edge)
///
/// The area share of a crossing is assigned to its adjacent atoms. If there are several, the
/// weights are proportional to the inverse of the distance from the van der Waals sphere of each
/// atom.
struct Summary {
  double area = 0;                 ///< Surface area, in square angstrom.
  std::vector<double> atom_areas;  ///< Area of each atom, in square angstrom, by atom index.
  double volume = 0;               ///< Enclosed volume, in cubic angstrom.
  /// Enclosed volume by the divergence theorem, in cubic angstrom:
  ///
  ///     divergence_volume = h^3 * (inside points + 1/3 * sum (t - 1/2))
  ///
  /// The sum is over all crossings, and t is the fraction of the crossed edge between its inside
  /// end and the crossing. For a surface within the grid this equals `h^2 * sum s * x[axis]`,
  /// averaged over the three axes, with s = 1 if the outside end is the upper end and s = -1
  /// otherwise. It is second order in h and more accurate than `volume`. If a region or a grid cuts
  /// the surface, it is the volume of the part within half a spacing of the points. The volumes of
  /// regions that divide a grid add up to the volume of the grid.
  double divergence_volume = 0;
  std::int64_t inside_points = 0;  ///< Number of grid points inside the surface.
  std::int64_t convex = 0;         ///< Number of crossings on convex patches: one atom.
  std::int64_t saddle = 0;         ///< Number of crossings on saddle patches: two atoms.
  std::int64_t concave = 0;        ///< Number of crossings on concave patches: three atoms.
  double convex_area = 0;          ///< Area of convex patches, in square angstrom.
  double saddle_area = 0;          ///< Area of saddle patches, in square angstrom.
  double concave_area = 0;         ///< Area of concave patches, in square angstrom.
  /// The number of crossings.
  std::int64_t edges() const { return convex + saddle + concave; }
  /// The filled cavities, in descending order of their voids; see SurfaceOptions::max_filled_void.
  std::vector<FilledCavity> filled_cavities;
  std::uint64_t bytes_written = 0;           ///< Total size of all files, in bytes.
  std::optional<MeshCounts> mesh;            ///< Size of the mesh, if there is one.
  std::optional<MeshQuality> mesh_quality;   ///< Angles, if MeshOptions::quality is set.
  std::optional<Verification> verification;  ///< Result of the verification, if there was one.
  PhaseSeconds seconds;                      ///< Times.
};

}  // namespace eses
