/// Sums over the crossings of edges with one patch. Highway includes this file once for each
/// instruction set.

#include <array>
#include <bit>
#include <cstdint>

#include "solve/edge_batch-inl.hpp"
#include "solve/tally.hpp"

#if defined(ESES_SOLVE_PATCH_TALLY_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_SOLVE_PATCH_TALLY_INL_
#undef ESES_SOLVE_PATCH_TALLY_INL_
#else
#define ESES_SOLVE_PATCH_TALLY_INL_
#endif

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

/// Rounds units as rounded_units() does. Lanes that are not in the mask become 0.
HWY_INLINE DoubleVector rounded_lanes(DoubleVector units, DoubleMask lanes) {
  return hn::IfThenElseZero(lanes, hn::Trunc(units + hn::CopySignToAbs(broadcast(0.5), units)));
}

/// Adds the crossings of edges with a patch of `count` atoms to a tally, with the results of
/// Tally::add_edge.
template <std::size_t count>
class PatchTally {
 public:
  HWY_INLINE PatchTally(const SurfaceModel& surface, const std::array<AtomIndex, count>& atoms,
                        double inverse_spacing, Tally& tally)
      : surface_(surface), atoms_(atoms), inverse_spacing_(inverse_spacing), tally_(tally) {
    clear();
  }

  /// Adds the edges of some lanes, the coordinates of their crossings along the axes, and the
  /// normals there.
  HWY_INLINE void operator()(const LaneEdges& edges, DoubleVector coordinates,
                             const Points& normals, DoubleMask lanes) {
    const auto units = broadcast(1 / area_share_unit), one = broadcast(1);
    crossings_ += std::popcount(mask_bits(Doubles(), lanes));
    const auto above = (coordinates - hn::Min(edges.from, edges.to)) * broadcast(inverse_spacing_);
    const auto fractions = hn::IfThenElse(edges.from > edges.to, above, one - above);
    lengths_ = lengths_ + rounded_lanes((fractions - broadcast(0.5)) * units, lanes);
    const auto shares = hn::Abs(edges.axes.of(normals)) * units;
    if constexpr (count == 1) {
      shares_[0] = shares_[0] + rounded_lanes(shares, lanes);
    } else {
      divide(shares, edges.axes.with(edges.outside, coordinates), lanes);
    }
  }

  /// Adds the sums to the tally. They are exact for the edges of a batch, each of which is added
  /// once at most: doubles hold all integers up to 2^53.
  HWY_INLINE void flush() {
    static_assert(EdgeBatch::capacity / area_share_unit < 0x1p53);
    if (crossings_ == 0) return;
    tally_.totals.crossings[count - 1] += crossings_;
    tally_.totals.inside_lengths += sum_of(lengths_);
    for (std::size_t q = 0; q < count; ++q) {
      const std::int64_t sum = sum_of(shares_[q]);
      tally_.atom_shares.add(atoms_[q], sum);
      tally_.totals.kind_shares[count - 1] += sum;
    }
    clear();
  }

 private:
  static HWY_INLINE std::int64_t sum_of(DoubleVector lanes) {
    return static_cast<std::int64_t>(hn::GetLane(hn::SumOfLanes(Doubles(), lanes)));
  }

  HWY_INLINE void clear() {
    crossings_ = 0;
    lengths_ = broadcast(0);
    for (auto& sum : shares_) sum = broadcast(0);
  }

  // Divides shares among two or three atoms.
  HWY_INLINE void divide(DoubleVector shares, const Points& points, DoubleMask lanes) {
    const auto gap = [&](std::size_t q) {
      const Atom& atom = surface_.atoms[atoms_[q]];
      const Points offset{points.x - broadcast(atom.center.x), points.y - broadcast(atom.center.y),
                          points.z - broadcast(atom.center.z)};
      return hn::Max(hn::Sqrt(squared_norm(offset)) - broadcast(atom.radius),
                     broadcast(Tally::min_gap));
    };
    const auto gap0 = gap(0), gap1 = gap(1);
    std::array<DoubleVector, count> weights;
    if constexpr (count == 2) {
      weights = {gap1, gap0};
    } else {
      const auto gap2 = gap(2);
      weights = {gap1 * gap2, gap2 * gap0, gap0 * gap1};
    }
    auto sum = weights[0] + weights[1];
    if constexpr (count == 3) sum = sum + weights[2];
    const auto scale = shares / sum;
    for (std::size_t q = 0; q < count; ++q)
      shares_[q] = shares_[q] + rounded_lanes(scale * weights[q], lanes);
  }

  const SurfaceModel& surface_;
  std::array<AtomIndex, count> atoms_;
  double inverse_spacing_;
  Tally& tally_;
  std::int64_t crossings_;
  DoubleVector lengths_;                    // in units of area_share_unit, like `shares_`
  std::array<DoubleVector, count> shares_;  // by atom
};

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
