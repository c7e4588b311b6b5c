#pragma once
/// Temporary files.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "system/file_descriptor.hpp"

namespace eses::detail {

/// A file without a name, which disappears with the object or the process, or a file with a name,
/// which is kept. Each failure throws Error with the directory of the file.
class ScratchFile {
 public:
  /// Creates a file without a name in the directory for temporary files (TMPDIR, or /tmp).
  ScratchFile();
  /// Creates a file without a name in `directory`.
  explicit ScratchFile(std::filesystem::path directory);
  enum class Kept { fresh, existing };
  /// Creates an empty file with a name that is kept, or opens an existing one for reading.
  ScratchFile(std::filesystem::path directory, const std::string& name, Kept kept);

  void append(std::span<const std::byte> bytes);
  /// Writes bytes at an offset. Several threads may call it for disjoint ranges. Does not change
  /// `size`.
  void write_at(std::span<const std::byte> bytes, std::uint64_t offset);
  /// Reads bytes, all of which must have been written.
  void read_at(std::span<std::byte> bytes, std::uint64_t offset) const;
  /// Descriptor of the file, open during the lifetime of the object.
  int descriptor() const { return file_.value(); }
  /// Waits until all written bytes are on the disk.
  void sync();
  /// Number of appended bytes.
  std::uint64_t size() const { return size_; }

 private:
  std::filesystem::path directory_;
  FileDescriptor file_;
  std::uint64_t size_ = 0;
};

}  // namespace eses::detail
