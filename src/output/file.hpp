#pragma once
/// Open files, and temporary files.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "system/file_descriptor.hpp"

namespace eses::detail {

/// Returns the bytes of values as they are in memory.
template <class Value>
auto as_chars(std::span<Value> values) {
  using Char = std::conditional_t<std::is_const_v<Value>, const char, char>;
  return std::span<Char>(reinterpret_cast<Char*>(values.data()), values.size_bytes());
}

/// An open file. Each failure throws Error with the name of the file.
class File {
 public:
  /// Writes bytes at an offset. Several threads may call it for disjoint ranges.
  void write_at(std::span<const char> bytes, std::uint64_t offset);
  /// Writes bytes after the bytes that were appended before.
  void append(std::span<const char> bytes);
  /// Sets the offset at which the next bytes are appended.
  void append_from(std::uint64_t offset) { appended_ = offset; }
  /// Returns the number of bytes in the file.
  std::uint64_t size() const;
  /// Reads bytes before the end of the file. Bytes in gaps that were never written are 0.
  void read_at(std::span<char> bytes, std::uint64_t offset) const;
  /// Waits until all written bytes are on the disk.
  void sync();

 protected:
  /// `name` and `read`, the verb for reading, are used in messages.
  explicit File(std::string name, const char* read = "read")
      : name_(std::move(name)), read_(read) {}
  File(File&&) = default;
  File& operator=(File&&) = default;
  ~File() = default;
  [[noreturn]] void fail(const char* verb, int error) const;

  FileDescriptor file_;

 private:
  std::string name_;
  const char* read_;
  std::uint64_t appended_ = 0;
};

/// A temporary file without a name, which disappears with the object or the process, or with a
/// name, which is kept. Messages have the directory of the file.
class ScratchFile : public File {
 public:
  /// Creates a file without a name in the directory for temporary files (TMPDIR, or /tmp).
  ScratchFile();
  /// Creates a file without a name in `directory`.
  explicit ScratchFile(const std::filesystem::path& directory);
  enum class Kept { fresh, existing };
  /// Creates an empty file with a name that is kept, or opens an existing one for reading.
  ScratchFile(const std::filesystem::path& directory, const std::string& name, Kept kept);
};

/// Copies the first `bytes` bytes of a file to another one from `begin` on. Calls `check` between
/// parts.
void copy_file(const File& from, std::uint64_t bytes, File& to, std::uint64_t begin,
               const std::function<void()>& check);

}  // namespace eses::detail
