#pragma once
/// Sectors of a contact circle that single caps provably cover, in single precision.
///
/// A circle has 64 sectors of equal pseudo-angles. Single precision only proves: a cap covers a
/// sector if it does so by more than the error bounds, which doc/algorithm.md derives, and it
/// touches all others that it may reach.

#include <bit>
#include <cstdint>
#include <vector>

#include "eses/vec3.hpp"
#include "geometry/cap_list.hpp"

namespace eses::detail {

/// A set of sectors: bit k stands for the pseudo-angles from k / 16 to (k + 1) / 16.
using Sectors = std::uint64_t;
inline constexpr int sector_count = 64, sectors_per_unit = 16;

/// Caps of a sphere in single precision, in units of its radius.
struct FloatCaps {
  std::vector<float> x, y, z, height;
  std::size_t count = 0;

  /// Replaces the caps by `size` caps of the list from `begin`, in this order. `heights` are those
  /// of the list, exact or slackened.
  void assign(const CapList& caps, const std::vector<double>& heights, std::size_t begin,
              std::size_t size, double radius);
};

/// The sectors that each cap covers or touches: those from `first`, `length` of them. There are
/// special lengths: `nothing`, and `whole` if the cap covers no sector and may touch all.
struct CoveredSectors {
  static constexpr std::int32_t nothing = -4, whole = sector_count;
  std::vector<std::int32_t> first, length;

  Sectors covered_by(std::size_t cap) const {
    const std::int32_t n = length[cap];
    return n > 0 && n < sector_count ? std::rotl((Sectors{1} << n) - 1, first[cap]) : 0;
  }
  /// With a margin of one sector at each end, besides the sectors of the ends. The first sector of
  /// a cap without any is any number, from which unsigned integers can be subtracted.
  Sectors touched_by(std::size_t cap) const {
    const std::int32_t n = length[cap] + 4;
    const auto begin = static_cast<std::int32_t>(static_cast<std::uint32_t>(first[cap]) - 2);
    return n >= sector_count ? ~Sectors{0} : std::rotl((Sectors{1} << n) - 1, begin);
  }
};

/// A contact circle in units of the radius of its first sphere, around whose centre the frame is:
/// the point at angle psi is height * axis + radius * (cos(psi) e1 + sin(psi) e2).
struct CircleInFrame {
  Vec3 axis, e1, e2;
  double height = 0, radius = 0;
};

/// Replaces `list` by the first `count` caps that touch one of these sectors, but for `own`. Zeros
/// follow the last one as far as a vector loop may read.
void list_touching(const CoveredSectors& covered, std::size_t count, Sectors sectors,
                   std::size_t own, std::vector<std::int64_t>& list);

/// Returns the sectors that no single cap provably covers. `covered` has the sectors of each cap
/// then, unless there are none. The own cap of the circle covers nothing.
Sectors find_open_sectors(const CircleInFrame& circle, const FloatCaps& caps,
                          CoveredSectors& covered);

}  // namespace eses::detail
