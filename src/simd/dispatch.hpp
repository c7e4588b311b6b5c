#pragma once
/// Which of the versions that Highway compiles, one per instruction set, runs on this processor.
///
/// Highway's own dispatcher lives in its shared library, which measures the timer's resolution when
/// it is loaded: 2 ms, a tenth of the run on a small protein. Its headers alone cost nothing.
///
/// All versions give the same bits: lanes do not depend on each other, only correctly rounded
/// operations are used, and multiply-adds are not contracted.

#include <string_view>

namespace eses::detail {

enum class InstructionSet { baseline, sse4, avx2, avx512 };

/// The widest one of the processor, or a narrower one named by the environment variable
/// ESES_INSTRUCTION_SET (baseline, sse4, avx2 or avx512) when it is first asked for.
InstructionSet instruction_set();

inline constexpr char instruction_set_variable[] = "ESES_INSTRUCTION_SET";

/// As the environment variable has them.
std::string_view name_of(InstructionSet set);
bool is_instruction_set(std::string_view name);

/// The versions of one function; null where the build has none, but for the baseline.
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

/// Pointer to the best version of a function that was compiled by way of hwy/foreach_target.h. To
/// be used in the namespace around HWY_NAMESPACE, once (#if HWY_ONCE).
#define ESES_BEST_VERSION(function)                                                     \
  ::eses::detail::best_version<decltype(&HWY_STATIC_DISPATCH(function))>(               \
      {HWY_CHOOSE_AVX3(function), HWY_CHOOSE_AVX2(function), HWY_CHOOSE_SSE4(function), \
       &HWY_STATIC_DISPATCH(function)})
