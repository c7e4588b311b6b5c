#pragma once
/// Parallel loops over atoms.

#include <algorithm>
#include <cstdint>
#include <functional>

#include "eses/atoms.hpp"
#include "system/parallel.hpp"

namespace eses::detail {

/// Number of atoms in a range. Processing a range takes much longer than starting a thread.
inline constexpr std::size_t atoms_per_loop_range = 4096;

/// Returns the number of ranges of a loop over `atoms` atoms.
inline std::size_t loop_range_count(std::size_t atoms) {
  return (atoms + atoms_per_loop_range - 1) / atoms_per_loop_range;
}

/// With fewer atoms for each thread, starting it costs more than it saves.
inline constexpr std::size_t min_atoms_per_thread = 1500;

/// Returns the number of threads, at most `threads`, that measure `atoms` atoms.
inline int threads_for_atoms(std::size_t atoms, int threads) {
  return static_cast<int>(
      std::clamp<std::size_t>(atoms / min_atoms_per_thread, 1, static_cast<std::size_t>(threads)));
}

/// Calls `body(index)` once for every index in [0, count), from at most `threads` threads.
inline void for_each_index(std::size_t count, int threads,
                           const std::function<void(std::size_t index)>& body) {
  parallel_for(static_cast<std::int64_t>(count), threads,
               [&](std::int64_t index, int) { body(static_cast<std::size_t>(index)); });
}

/// Divides [0, atoms) into ranges and calls `body(range, begin, end)` for each. `range` is the
/// 0-based number of the range [begin, end).
inline void for_loop_ranges(
    std::size_t atoms, int threads,
    const std::function<void(std::size_t range, AtomIndex begin, AtomIndex end)>& body) {
  for_each_index(loop_range_count(atoms), threads, [&](std::size_t range) {
    const std::size_t begin = range * atoms_per_loop_range;
    const std::size_t end = std::min(begin + atoms_per_loop_range, atoms);
    body(range, static_cast<AtomIndex>(begin), static_cast<AtomIndex>(end));
  });
}

}  // namespace eses::detail
