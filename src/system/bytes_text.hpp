#pragma once
/// Numbers of bytes in words.

#include <cstdint>
#include <string>

namespace eses::detail {

/// In powers of 1000 and to three digits: `512 B`, `34.9 MB`, `24.2 GB`.
std::string bytes_text(std::uint64_t bytes);

/// In powers of 1024, as `--max-memory` counts: `33.4 MiB`, `20 GiB`.
std::string binary_bytes_text(std::uint64_t bytes);

}  // namespace eses::detail
