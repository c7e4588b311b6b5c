#pragma once
/// Owner of a file descriptor, with transfers that are complete.

#include <unistd.h>

#include <cstdint>
#include <span>
#include <utility>

namespace eses::detail {

/// A range of bytes of one file and the offset of its copy in another file.
struct CopyRange {
  std::uint64_t from = 0, to = 0;  ///< offsets
  std::uint64_t bytes = 0;
};

/// Owns a file descriptor. Transfers continue after interrupts and throw std::system_error.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int value) : value_(value) {}
  ~FileDescriptor() { close(); }
  FileDescriptor(FileDescriptor&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(value_, other.value_);
    return *this;
  }

  bool is_open() const { return value_ >= 0; }
  int value() const { return value_; }

  /// Reads from `offset` until `bytes` is full or the file ends. Returns the number of bytes read.
  std::size_t read_at(std::span<char> bytes, std::uint64_t offset) const;
  /// Writes all bytes at `offset`. Several threads may call it for disjoint ranges.
  void write_at(std::span<const char> bytes, std::uint64_t offset) const;
  /// Copies a range of another open regular file inside the kernel, see copy_file_range(2). Returns
  /// the number of bytes copied from the beginning of the range. It is less than `range.bytes`,
  /// perhaps 0, if the other file ends or if the file systems do not support the copy.
  std::uint64_t copy_from(int file, const CopyRange& range) const;

  /// Whether the file is in a local file system, where all processes of the machine see written
  /// bytes at once. Returns false if the type of the file system is not known.
  bool is_in_local_file_system() const;

  /// Returns 0, or -1 and sets errno. The descriptor is released in either case.
  int close() noexcept { return is_open() ? ::close(std::exchange(value_, -1)) : 0; }

 private:
  int value_ = -1;
};

}  // namespace eses::detail
