#pragma once
/// A hash function for 64-bit integers.

#include <cstdint>

namespace eses::detail {

/// Returns the output of the SplitMix64 generator whose state is `number`. The function is a
/// bijection. Generator: Steele, Lea and Flood, "Fast splittable pseudorandom number generators",
/// OOPSLA 2014, doi:10.1145/2660193.2660195; constants: David Stafford's "Mix13", as in Vigna's
/// reference implementation, https://prng.di.unimi.it/splitmix64.c.
inline std::uint64_t splitmix64(std::uint64_t number) {
  number += 0x9e3779b97f4a7c15;
  number = (number ^ (number >> 30)) * 0xbf58476d1ce4e5b9;
  number = (number ^ (number >> 27)) * 0x94d049bb133111eb;
  return number ^ (number >> 31);
}

}  // namespace eses::detail
