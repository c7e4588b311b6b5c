/// A solver that gives wrong results on purpose. It replaces solve/block_solver.cpp, whose
/// functions it calls under other names. The environment variable ESES_SPOIL chooses the error of
/// every result: `point`, `crossing`, `normal` or `atoms`. Without it the results are right.

// NOLINTBEGIN(readability-identifier-naming,bugprone-suspicious-include): functions, renamed
#define solve_block right_solve_block
#define solve_block_for_mesh right_solve_block_for_mesh
#include "solve/block_solver.cpp"
#undef solve_block
#undef solve_block_for_mesh
// NOLINTEND(readability-identifier-naming,bugprone-suspicious-include)

#include <cstdlib>
#include <string_view>

namespace eses::detail {
namespace {

void spoil(BlockResult& result) {
  const char* const text = std::getenv("ESES_SPOIL");
  const std::string_view what = text == nullptr ? "" : text;
  if (what == "point")
    for (std::uint64_t& word : result.inside.words) word = ~word;
  for (BlockCrossing& crossing : result.crossings) {
    if (what == "crossing") crossing.coordinate += 1e-5;
    if (what == "normal")
      crossing.normal = normalized(crossing.normal + 1e-3 * any_perpendicular(crossing.normal));
    if (what == "atoms") ++crossing.atoms[static_cast<std::size_t>(crossing.atom_count - 1)];
  }
}

}  // namespace

BlockResult solve_block(const Patches& patches, const Grid& grid, const BlockBounds& block,
                        BlockWorkspace& workspace) {
  BlockResult result = right_solve_block(patches, grid, block, workspace);
  spoil(result);
  return result;
}

BlockResult solve_block_for_mesh(const Patches& patches, const Grid& grid, const BlockBounds& block,
                                 const BlockBounds& wider, BlockWorkspace& workspace) {
  BlockResult result = right_solve_block_for_mesh(patches, grid, block, wider, workspace);
  spoil(result);
  return result;
}

}  // namespace eses::detail
