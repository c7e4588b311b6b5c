#pragma once
/// File copies inside the kernel, without passing through the memory of the process.

#include <cstdint>

namespace eses::detail {

/// A range of bytes of one file and the offset of its copy in another file.
struct CopyRange {
  std::uint64_t from = 0, to = 0;  ///< offsets
  std::uint64_t bytes = 0;
};

/// Copies a range between open regular files, see copy_file_range(2). Returns the number of bytes
/// copied from the beginning of the range. If the file systems do not support the copy, fewer than
/// `range.bytes` bytes are copied, perhaps 0. Throws std::system_error if writing fails for another
/// reason.
std::uint64_t copy_in_kernel(int from, int to, const CopyRange& range);

/// Whether a file is in a local file system, where all processes of the machine see written bytes
/// at once. Returns false if the type of the file system is not known.
bool is_in_local_file_system(int file);

}  // namespace eses::detail
