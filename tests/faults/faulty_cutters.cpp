/// A search for cutters that misses some on purpose. It replaces surface/cutters.cpp, whose
/// function it calls under another name. If the environment variable ESES_SPOIL is `cutter`, every
/// fifth placement is cut by one placement less. Otherwise the result is right.

// NOLINTBEGIN(readability-identifier-naming,bugprone-suspicious-include): functions, renamed
#define find_cutters right_find_cutters
#include "surface/cutters.cpp"
#undef find_cutters
// NOLINTEND(readability-identifier-naming,bugprone-suspicious-include)

#include <cstdlib>
#include <string_view>

namespace eses::detail {

void find_cutters(const PlacementIndex& placements, ConcaveScratch& scratch, ConcavePatch& patch) {
  right_find_cutters(placements, scratch, patch);
  const char* const text = std::getenv("ESES_SPOIL");
  if (text == nullptr || std::string_view(text) != "cutter") return;
  if (as_number(patch.number) % 5 != 0 || patch.cutters.empty()) return;
  patch.cutters.pop_back();
  patch.caps.pop_back();
}

}  // namespace eses::detail
