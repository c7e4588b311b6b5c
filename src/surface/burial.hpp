#pragma once
/// A proof that an atom is buried, and the few caps that matter where it is not, before any circle
/// is looked at.
///
/// The SAS sphere is covered by small patches around fixed directions. A patch that lies wholly in
/// one cap is settled. If all are settled the atom is buried. Otherwise what is accessible lies in
/// the patches left over, and on their ground two sets of caps suffice: those that settled a patch,
/// and those whose circle passes through a patch left over. Their union equals that of all caps.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/cap_list.hpp"
#include "geometry/covering_directions.hpp"

namespace eses::detail {

/// Frequency of the covering directions: 162 of them. More cost more than they settle.
inline constexpr int burial_frequency = 5;

/// The covering directions in the layout of the kernel; built once, read by all threads.
struct BurialPatches {
  std::vector<float> x, y, z;
  double cosine = 1, sine = 0;  ///< of the angular radius of every patch

  explicit BurialPatches(const CoveringDirections& covering);
};

/// A cap as the kernel sees it.
struct BurialCap {
  float x, y, z;  ///< axis
  float settled;  ///< patches whose centre is at least at this cosine from the axis lie in it
  std::uint32_t number;  ///< index of the cap
  bool is_used;          ///< it settled a patch
};

/// The outcome: which of the caps given matter.
struct BurialScratch {
  std::vector<float> settled, touched;  ///< for each cap, cosines at which it settles a patch, and
                                        ///< at which it may have some of it
  std::vector<std::uint32_t> order;     ///< numbers of the caps, the largest first
  std::vector<BurialCap> caps;          ///< in this order
  std::vector<std::uint32_t> relevant;  ///< caps whose circle may be accessible
  std::vector<std::uint32_t> covering;  ///< further caps that are needed to cover
  std::vector<float> x, y, z;           ///< patches not yet settled
};

/// True if the caps, each slackened to its blocking height, provably cover the sphere of `radius`.
/// If not, fills `relevant` and `covering` with indices of caps whose union equals the union of all
/// caps, both exact and slackened.
bool is_buried(const CapList& caps, double radius, const BurialPatches& patches,
               BurialScratch& scratch);

}  // namespace eses::detail
