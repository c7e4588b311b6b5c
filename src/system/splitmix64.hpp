#pragma once
/// Numbers that look random.

#include <cstdint>

namespace eses::detail {

/// The output function of SplitMix64 (Steele et al., OOPSLA 2014): different numbers for different
/// ones.
inline std::uint64_t splitmix64(std::uint64_t number) {
  number += 0x9e3779b97f4a7c15;
  number = (number ^ (number >> 30)) * 0xbf58476d1ce4e5b9;
  number = (number ^ (number >> 27)) * 0x94d049bb133111eb;
  return number ^ (number >> 31);
}

}  // namespace eses::detail
