#pragma once
/// Owner of a file descriptor, with transfers that are complete.

#include <unistd.h>

#include <cstdint>
#include <span>
#include <utility>

namespace eses::detail {

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

  /// Returns 0, or -1 and sets errno. The descriptor is released in either case.
  int close() noexcept { return is_open() ? ::close(std::exchange(value_, -1)) : 0; }

 private:
  int value_ = -1;
};

}  // namespace eses::detail
