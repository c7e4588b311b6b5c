// Uses the library with a solver that gives wrong results. The verification throws the faults, and
// no file is left.

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <vector>

#include "eses/eses.hpp"
#include "support/temporary_directory.hpp"

namespace {

bool finds_faults(const std::function<void()>& action) {
  try {
    action();
  } catch (const eses::VerificationError& error) {
    const eses::Verification& found = error.verification();
    return !found.faults.empty() && !found.faults[0].empty() && found.edges > 0;
  }
  return false;
}

int failures = 0;

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "not so: %s\n", what);
  ++failures;
}

}  // namespace

int main() {
  const std::vector<eses::Atom> atoms{{{0, 0, 0}, 1.7}, {{2.5, 0.3, 0}, 1.5}};
  const eses::Surface surface(atoms);
  const eses::Grid grid = eses::make_grid(surface);
  const eses::RunOptions options{.verify = 200};
  const eses::detail::test::TemporaryDirectory directory;

  ::setenv("ESES_SPOIL", "normal", 1);
  require(finds_faults([&] { eses::compute(surface, grid, options); }), "compute finds faults");
  require(finds_faults([&] {
            eses::for_each_block(
                surface, grid, [](const auto&) {}, options);
          }),
          "for_each_block finds faults");
  require(finds_faults([&] { eses::write_files(surface, grid, directory.path(), {}, options); }),
          "write_files finds faults");
  require(!std::filesystem::exists(directory.path() / "bounding_box.txt"), "no file is left");

  ::unsetenv("ESES_SPOIL");
  const eses::Result result = eses::compute(surface, grid, options);
  require(result.summary().verification->faults.empty(), "right results have no faults");
  require(result.summary().verification->points == 200, "as many points are checked as requested");
  return failures == 0 ? 0 : 1;
}
