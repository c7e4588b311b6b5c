#pragma once
/// Verification of a run: random points and edges against the definition of the surface, and the
/// number of inside points against the exact volume.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eses/check.hpp"
#include "eses/run_options.hpp"
#include "eses/summary.hpp"
#include "geometry/tiling.hpp"
#include "run/sink.hpp"
#include "surface/cavity_map.hpp"
#include "surface/molecule.hpp"
#include "verify/definition.hpp"
#include "verify/sample.hpp"

namespace eses::detail {

/// The verification of a run. Points are drawn before the run, from the points between the van der
/// Waals and the SAS surface. During the run, a random sample of crossings is kept, four times as
/// many as are verified. Half of the verified crossings are chosen at random from this sample; the
/// others are the crossings nearest to the seam with another patch.
class Verifier final : public Sink {
 public:
  /// Verifies `checks` points and edges of the region of a tiling. Keeps views of all arguments,
  /// which must outlive the object. `cavities` is null if none are filled.
  Verifier(std::span<const Atom> atoms, double probe_radius, const Grid& grid,
           const BlockTiling& tiling, int threads, std::int64_t checks,
           const CavityMap* cavities = nullptr);

  /// Returns the estimated memory of a verification in bytes, for this number of crossings.
  static double memory_bytes(std::int64_t checked, int threads, double crossings);

  /// Takes the sampled points and crossings of a block. `thread` is in [0, threads).
  void take_block(const BlockResult& result, std::size_t thread) override;

  /// Performs all checks after the last block. Calls `progress`, if it is not empty, from the
  /// calling thread with the number of finished checks. An exception of `progress` ends the
  /// verification.
  Verification check(const ProgressCallback& progress);

 private:
  struct SampledPoint {
    std::int64_t block = 0;  // index of the block that owns the point
    GridIndex index{};
    std::optional<bool> is_inside;  // empty until the block is solved
  };

  const Grid& grid_;
  const BlockTiling& tiling_;
  int threads_;
  std::size_t checks_;
  verify::Definition definition_;
  std::vector<SampledPoint> points_;             // by block
  std::vector<verify::CrossingSample> samples_;  // per thread
  std::vector<verify::CentreSearch> searches_;
};

/// Bounds of a volume (cubic angstrom).
struct VolumeBounds {
  double low = 0, high = 0;
};

/// Returns bounds of the total volume of the grid's cells around the inside points, for any grid
/// with this spacing (angstrom) that encloses the molecule. A cell is a cube around a grid point.
///
/// Let d(x) be the distance of x from the accessible set, and p the probe radius. A point is inside
/// if d >= p. A point and the centre of its cell are at most s = sqrt(3) / 2 spacing apart, so
/// their values of d differ by at most s. Therefore the cells of inside points cover the set d >= p
/// + s, and lie in the set d >= p - s. The set d >= t is inside the surface of a probe of radius t
/// for atoms with the same SAS spheres, and its volume is exact.
VolumeBounds bound_inside_cells(const Molecule& molecule, double probe_radius, double spacing,
                                int threads, const CheckCallback& check);

/// Compares the number of inside points of such a grid with the bounds. Returns the fault, if any.
std::optional<std::string> find_volume_fault(std::int64_t inside_points, double spacing,
                                             const VolumeBounds& bounds);

}  // namespace eses::detail
