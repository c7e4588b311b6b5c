#pragma once
/// Values of the options of the surface command. Each function returns nothing if a text has
/// another format.

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "eses/outputs.hpp"
#include "grid/tiling.hpp"
#include "run/request.hpp"

namespace eses::detail::cli {

inline constexpr double min_positive = std::numeric_limits<double>::denorm_min();
inline constexpr double max_finite = std::numeric_limits<double>::max();

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
