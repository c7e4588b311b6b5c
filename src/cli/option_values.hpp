#pragma once
/// Texts of options as values: numbers, positions, boxes, parts of a grid and lists of files. Each
/// function that parses a text returns nothing if it has another format.

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/arguments.hpp"
#include "eses/grid.hpp"
#include "eses/outputs.hpp"
#include "run/request.hpp"

namespace eses::detail::cli {

inline constexpr double max_finite = std::numeric_limits<double>::max();

/// Accepts finite numbers of at least 0, or greater than 0. `unit` is part of the message.
Format<double> at_least_0(std::string_view unit);
Format<double> greater_than_0(std::string_view unit);

/// Parses a list of exactly `count` numbers in [min, max].
template <std::size_t count, class Number>
std::optional<std::array<Number, count>> numbers_in(const std::string& list, char separator,
                                                    Number min, Number max) {
  const std::vector<std::string> parts = split(list, separator);
  if (parts.size() != count) return std::nullopt;
  std::array<Number, count> numbers{};
  for (std::size_t i = 0; i < count; ++i) {
    const std::optional<Number> number = whole_text<Number>(parts[i]);
    if (!number || !(*number >= min && *number <= max)) return std::nullopt;  // also for NaN
    numbers[i] = *number;
  }
  return numbers;
}

/// Parses a whole number of bytes, with an optional suffix for a power of 1024: K, M, G or T.
std::optional<std::uint64_t> bytes_in(const std::string& text);
/// Parses `x0,y0,z0,x1,y1,z1`, the ends of a box.
std::optional<Box> box_in(const std::string& text);
std::optional<Vec3> position_in(const std::string& text);
/// Parses the number of points of a grid along x, y and z.
std::optional<GridIndex> counts_in(const std::string& text);
/// Parses `i0:i1,j0:j1,k0:k1`.
std::optional<BlockRange> blocks_in(const std::string& text);
/// Parses `K/N`.
std::optional<Share> part_in(const std::string& text);
/// Parses the number of a cavity, or `outside`.
std::optional<std::uint32_t> component_in(const std::string& text);
/// Returns `outputs` with the text files of a list.
std::optional<Outputs> with_text_files(const std::string& list, Outputs outputs);
/// Removes the four text files of ESES.
void leave_out_text_files(Outputs& outputs);

// These functions return whether a text is the name of such a file, or the first part of one.
bool is_map(const std::string& text);
bool is_dx_map(const std::string& text);
bool is_dx_grid(const std::string& text);
bool is_prefix(const std::string& text);

}  // namespace eses::detail::cli
