#pragma once
/// Byte counts as text with a unit.

#include <cstdint>
#include <string>

namespace eses::detail {

/// Formats a byte count with three digits and a decimal unit: `512 B`, `34.9 MB`, `24.2 GB`.
std::string bytes_text(std::uint64_t bytes);

/// Formats a byte count with three digits and a binary unit, as `--max-memory` accepts it:
/// `33.4 MiB`, `20 GiB`.
std::string binary_bytes_text(std::uint64_t bytes);

}  // namespace eses::detail
