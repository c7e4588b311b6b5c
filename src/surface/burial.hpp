#pragma once
/// A fast proof that an atom is buried, and a selection of the relevant caps of other atoms, before
/// any contact circle is computed.
///
/// Small discs around fixed directions cover the SAS sphere. A disc is settled if it lies in a
/// single cap. If all discs are settled, the atom is buried. Otherwise, all accessible points lie
/// in the remaining discs. Then two sets of caps suffice: those that settled a disc, and those that
/// may reach into a remaining disc. Their union equals the union of all caps. doc/algorithm.md
/// derives this.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/cap_list.hpp"
#include "geometry/covering_directions.hpp"

namespace eses::detail {

/// Frequency of the covering directions, which gives 252 of them. More directions would take more
/// time than they save.
inline constexpr int burial_frequency = 5;

/// The covering directions as a structure of arrays. Built once, read by all threads.
struct BurialPatches {
  std::vector<float> x, y, z;
  double cosine = 1, sine = 0;  ///< cosine and sine of the angular radius of every patch

  explicit BurialPatches(const CoveringDirections& covering);
};

/// A cap in the layout of the kernel.
struct BurialCap {
  float x, y, z;         ///< axis
  float settled;         ///< minimum cosine from the axis of the patches that lie in the cap
  std::uint32_t number;  ///< index of the cap
  bool is_used;          ///< whether the cap settled a patch
};

/// Scratch memory of is_buried, and its selection of caps.
struct BurialScratch {
  std::vector<float> settled;   ///< by cap: minimum cosine from the axis of patches that lie in it
  std::vector<float> touched;   ///< by cap: minimum cosine from the axis of patches it may reach
  std::vector<BurialCap> caps;  ///< all caps, the largest first
  std::vector<std::uint32_t> relevant;  ///< result: caps whose circle may be accessible
  std::vector<std::uint32_t> covering;  ///< result: further caps that are needed to cover
  std::vector<float> x, y, z;           ///< patches that are not settled yet
};

/// Returns whether the caps, each with its blocking height, provably cover a sphere of this radius
/// (angstrom). If not, fills `relevant` and `covering` with indices of caps whose union equals the
/// union of all caps, both exact and slackened.
bool is_buried(const CapList& caps, double radius, const BurialPatches& patches,
               BurialScratch& scratch);

}  // namespace eses::detail
