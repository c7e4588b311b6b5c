// The same bytes whatever instruction set the processor offers.

#include <hwy/targets.h>

#include "catch.hpp"
#include "eses/run.hpp"
#include "support/atom_sets.hpp"
#include "support/eses_files.hpp"
#include "support/temporary_directory.hpp"

namespace eses::test {
namespace {

std::string all_bytes(std::span<const Atom> atoms, std::int64_t block_size) {
  const TemporaryDirectory directory;
  Parameters parameters;
  parameters.threads = 1;
  parameters.block_size = block_size;
  run(atoms, make_plan(atoms, parameters, {}), {}, directory.path());
  std::string bytes;
  for (const char* name : eses_file_names) bytes += read_bytes(directory.path() / name);
  return bytes;
}

void use_targets(std::int64_t targets) {
  hwy::SetSupportedTargetsForTest(targets);
  hwy::GetChosenTarget().DeInit();
}

}  // namespace

TEST_CASE("the files do not depend on the instruction set") {
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  REQUIRE(!targets.empty());
  for (const auto& atoms : {make_chain(300, 9), make_cube(4, 3.0, 1.5), make_icosahedron(4, 1.7)})
    for (const std::int64_t block_size : {64, 100}) {
      const std::string expected = all_bytes(atoms, block_size);
      for (const std::int64_t target : targets) {
        use_targets(target);
        INFO(hwy::TargetName(target));
        CHECK(all_bytes(atoms, block_size) == expected);
        use_targets(0);
      }
    }
}

}  // namespace eses::test
