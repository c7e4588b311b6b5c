#pragma once
/// A fast proof that an atom is buried, and a selection of the relevant caps of other atoms, before
/// any contact circle is computed.
///
/// Small discs around fixed directions cover the SAS sphere. A disc is settled if it lies in a
/// single cap. If all discs are settled, the atom is buried. Otherwise, all accessible points lie
/// in the remaining discs. Then two sets of caps suffice: those that settled a disc, and those that
/// may reach into a remaining disc. Their union equals the union of all caps. doc/algorithm.md
/// derives this.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/cap_list.hpp"
#include "geometry/covering_directions.hpp"

namespace eses::detail {

/// Unit vectors as a structure of arrays, in units of 1 / direction_scale. In 16 bits, a vector
/// holds twice as many of them as in single precision.
struct DirectionList {
  std::vector<std::int16_t> x, y, z;
};
inline constexpr double direction_scale = 32767;

/// Scale of the cosines that are computed from such vectors: sums of the upper 16 bits of products.
/// Rounding the components moves the sum by at most (|x1| + |y1| + ... + |z2|) / 4, which is less
/// than 0.9, and the loss of the lower bits reduces it by less than 3.
inline constexpr double cosine_scale = direction_scale * direction_scale / 0x1p16;
inline constexpr double max_cosine_excess = 0.9, max_cosine_deficit = 3.9;

/// The covering directions, read by all threads.
struct BurialPatches {
  DirectionList directions;  ///< padded for vector loops
  std::size_t count = 0;
  double cosine = 1, sine = 0;  ///< cosine and sine of the angular radius of every patch

  explicit BurialPatches(const CoveringDirections& covering);
};

/// Returns the covering directions for a surface with or without a probe. They are built once.
const BurialPatches& burial_patches(bool has_probe);

/// Caps in the layout of the kernel. Limits are scaled cosines: a cap settles the patches, or may
/// reach the patches, for which scaled_cosine() of axis and patch is greater.
struct BurialCaps {
  DirectionList axes;
  std::vector<std::int16_t> settled;  ///< limit of the patches that lie in the cap
  std::vector<std::int16_t> touched;  ///< limit of the patches that the cap may reach
  std::vector<std::int32_t> step;     ///< step of size; the largest caps have the lowest step
  std::vector<std::uint8_t> is_used;  ///< whether the cap settled a patch
  std::vector<std::uint32_t> order;   ///< indices of all caps, the largest first

  /// Memory of a cap in bytes.
  static constexpr std::size_t bytes_per_cap = 5 * sizeof(std::int16_t) + sizeof(std::int32_t) +
                                               sizeof(std::uint8_t) + sizeof(std::uint32_t);
};

/// Scratch memory of is_buried, and its selection of caps.
struct BurialScratch {
  BurialCaps caps;
  DirectionList unsettled;              ///< patches that are not settled yet
  std::vector<std::uint32_t> relevant;  ///< result: caps whose circle may be accessible
  std::vector<std::uint32_t> covering;  ///< result: further caps that are needed to cover
};

/// Returns whether the caps, each with its blocking height, provably cover a sphere of this radius
/// (angstrom). If not, fills `relevant` and `covering` with indices of caps whose union equals the
/// union of all caps, both exact and slackened.
bool is_buried(const CapList& caps, double radius, const BurialPatches& patches,
               BurialScratch& scratch);

}  // namespace eses::detail
