#pragma once
/// Copies between files that do not pass through the memory of the process.

#include <cstdint>

namespace eses::detail {

/// Bytes of one file, and their place in another one.
struct CopyRange {
  std::uint64_t from = 0, to = 0;  ///< offsets
  std::uint64_t bytes = 0;
};

/// Copies a range between open regular files, see copy_file_range(2). Returns the number of bytes
/// copied from the beginning of the range: fewer than `range.bytes`, perhaps 0, where the file
/// systems cannot do more. Throws std::system_error if writing fails for another reason.
std::uint64_t copy_in_kernel(int from, int to, const CopyRange& range);

/// Whether a file is in a local file system, where all processes of the machine see what one of
/// them writes at once. False if that is not known.
bool is_in_local_file_system(int file);

}  // namespace eses::detail
