#pragma once
/// Includes Catch2, whichever major version is installed.

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;  // version 2 has it in the global namespace
#else
#include <catch2/catch.hpp>
// Version 2 gets the names of version 3.
namespace Catch {
using Detail::Approx;
namespace Matchers {
// NOLINTNEXTLINE(readability-identifier-naming): as in version 3
inline auto ContainsSubstring(const std::string& text) { return Contains(text); }
}  // namespace Matchers
}  // namespace Catch

// Ends the test case. ctest counts it as skipped because of the printed text, even if assertions
// have failed before, so it must come first. It returns from the current function, so it must be in
// the test case itself.
#define SKIP(reason)                    \
  do {                                  \
    WARN("test skipped: " << (reason)); \
    return;                             \
  } while (false)
#endif
