#pragma once
/// Sums of a range of planes.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "eses/summary.hpp"
#include "input/file_index.hpp"
#include "solve/area_shares.hpp"
#include "solve/region_totals.hpp"

namespace eses::detail {

/// The sums of a range without those of its atoms.
struct RangeSums {
  std::int64_t verified_points = 0, verified_edges = 0;
  MeshCounts mesh;
  RegionTotals totals;

  void add(const RangeSums& other) {
    verified_points += other.verified_points;
    verified_edges += other.verified_edges;
    mesh.vertices += other.mesh.vertices;
    mesh.triangles += other.mesh.triangles;
    totals.add(other.totals);
  }
};

/// An atom's area share of a range, in units of `area_share_unit`.
struct AtomSum {
  AreaShare share = 0;
  FileIndex atom{};
  std::array<std::uint32_t, 3> padding{};  ///< explicit padding, as the struct is written to disk
};

/// The sums of a sweep. They do not depend on the division of its region into blocks. The engine
/// adds those of the verification.
struct SweepSums : RangeSums {
  std::vector<AreaShare> atom_shares;  ///< by atom of the surface
  std::size_t fault_count = 0;         ///< of the verification
  PhaseSeconds seconds;                ///< of all threads
};

}  // namespace eses::detail
