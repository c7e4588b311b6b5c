#pragma once
/// Runs tests of functions that are compiled for several instruction sets, for each version.

#include <hwy/highway.h>

#include "catch.hpp"
#include "system/dispatch.hpp"

namespace eses::detail::test {

/// Calls `check(function)` for every version that the build has and instruction_set() allows.
template <class Function, class Check>
void for_each_version(const Versions<Function>& versions, Check&& check) {
  const auto check_version = [&](InstructionSet set, const char* name, Function function) {
    if (function == nullptr || set > instruction_set()) return;
    INFO(name);
    check(function);
  };
  check_version(InstructionSet::baseline, "baseline", versions.baseline);
  check_version(InstructionSet::sse4, "sse4", versions.sse4);
  check_version(InstructionSet::avx2, "avx2", versions.avx2);
  check_version(InstructionSet::avx512, "avx512", versions.avx512);
}

}  // namespace eses::detail::test

/// All versions of a function. Used like ESES_BEST_VERSION.
#define ESES_VERSIONS(function)                                                      \
  ::eses::detail::Versions<decltype(&HWY_STATIC_DISPATCH(function))> {               \
    HWY_CHOOSE_AVX3(function), HWY_CHOOSE_AVX2(function), HWY_CHOOSE_SSE4(function), \
        &HWY_STATIC_DISPATCH(function)                                               \
  }
