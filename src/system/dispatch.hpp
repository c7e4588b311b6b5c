#pragma once
/// Choice of the instruction set at run time.
///
/// Highway compiles a kernel once for each instruction set. Its own dispatcher is in its shared
/// library, which spends 2 ms on measuring the timer's resolution when it is loaded. That is a
/// tenth of the run time for a small protein, so this folder uses Highway's headers only.
///
/// Only x86 has several versions. The baseline of aarch64 has the vectors of NEON.
///
/// All versions of a kernel return the same bits: lanes are independent of each other, only
/// correctly rounded operations are used, and multiply-adds are not contracted.

#include <string_view>

namespace eses::detail {

enum class InstructionSet { baseline, sse4, avx2, avx512 };

/// Returns the widest instruction set of the processor, limited by the environment variable
/// ESES_INSTRUCTION_SET (baseline, sse4, avx2 or avx512), which is read at the first call.
InstructionSet instruction_set();

inline constexpr char instruction_set_variable[] = "ESES_INSTRUCTION_SET";

/// Returns the name of an instruction set, as the environment variable spells it.
std::string_view name_of(InstructionSet set);

/// Returns whether `name` is the name of an instruction set.
bool is_instruction_set(std::string_view name);

/// The versions of one function. A version that the build does not have is null; the baseline
/// always exists.
template <class Function>
struct Versions {
  Function avx512, avx2, sse4, baseline;
};

template <class Function>
Function best_version(const Versions<Function>& versions) {
  const InstructionSet best = instruction_set();
  if (best >= InstructionSet::avx512 && versions.avx512 != nullptr) return versions.avx512;
  if (best >= InstructionSet::avx2 && versions.avx2 != nullptr) return versions.avx2;
  if (best >= InstructionSet::sse4 && versions.sse4 != nullptr) return versions.sse4;
  return versions.baseline;
}

}  // namespace eses::detail

/// Pointer to the best version of a function that was compiled through hwy/foreach_target.h. Use it
/// in the namespace that encloses HWY_NAMESPACE, within `#if HWY_ONCE`.
#define ESES_BEST_VERSION(function)                                                     \
  ::eses::detail::best_version<decltype(&HWY_STATIC_DISPATCH(function))>(               \
      {HWY_CHOOSE_AVX3(function), HWY_CHOOSE_AVX2(function), HWY_CHOOSE_SSE4(function), \
       &HWY_STATIC_DISPATCH(function)})
