#include "system/dispatch.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>

namespace eses::detail {
namespace {

// Tests the processor features that Highway's targets require. Features that occur only together
// are tested once.
InstructionSet widest_available() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_cpu_init();
  const bool has_sse4 = __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("pclmul");
  const bool has_avx2 = has_sse4 && __builtin_cpu_supports("avx2") &&
                        __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
                        __builtin_cpu_supports("bmi2");
  const bool has_avx512 = has_avx2 && __builtin_cpu_supports("avx512f") &&
                          __builtin_cpu_supports("avx512vl") &&
                          __builtin_cpu_supports("avx512bw") &&
                          __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512cd");
  if (has_avx512) return InstructionSet::avx512;
  if (has_avx2) return InstructionSet::avx2;
  if (has_sse4) return InstructionSet::sse4;
#endif
  return InstructionSet::baseline;
}

constexpr std::array<std::string_view, 4> instruction_set_names{"baseline", "sse4", "avx2",
                                                                "avx512"};

std::optional<InstructionSet> set_named(std::string_view name) {
  const auto* const found =
      std::find(instruction_set_names.begin(), instruction_set_names.end(), name);
  if (found == instruction_set_names.end()) return std::nullopt;
  return static_cast<InstructionSet>(found - instruction_set_names.begin());
}

InstructionSet widest_allowed() {
  const char* const wish = std::getenv(instruction_set_variable);
  return set_named(wish != nullptr ? wish : "").value_or(InstructionSet::avx512);
}

}  // namespace

InstructionSet instruction_set() {
  static const InstructionSet chosen = std::min(widest_available(), widest_allowed());
  return chosen;
}

std::string_view name_of(InstructionSet set) {
  return instruction_set_names[static_cast<std::size_t>(set)];
}

bool is_instruction_set(std::string_view name) { return set_named(name).has_value(); }

}  // namespace eses::detail
