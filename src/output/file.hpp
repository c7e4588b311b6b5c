#pragma once
/// Open files, temporary files, and output files that are either complete or absent.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "output/output_directory.hpp"
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

/// Throws Error if `path` is, after following symbolic links, something that a regular file must
/// not replace: a directory, device, FIFO or socket.
void require_replaceable(const std::string& path);

/// A file that is written under a temporary name in its final directory. `commit` gives it its
/// final name. If the object is destroyed without `commit`, the temporary file is removed.
class OutputFile : public File {
 public:
  /// Keeps a reference to `directory`, which must outlive the file. Throws Error if the file cannot
  /// be created, or if require_replaceable refuses its path.
  OutputFile(const OutputDirectory& directory, std::string name);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Final path of the file.
  std::string path() const { return path_in(directory_.path(), name_); }

  /// Closes the file. Some file systems report failed writes only here.
  void close();
  /// Removes an older file of the final name, if there is one.
  void remove_older() const { directory_.remove(name_); }
  /// Renames the closed file, replacing any older one.
  void commit();
  /// Removes the file again if it was committed.
  void withdraw() noexcept;

 private:
  const OutputDirectory& directory_;
  std::string name_, temporary_name_;
  bool is_temporary_ = false, is_committed_ = false;
};

/// Closes files, removes older ones and calls `remove_others`, and then commits the files, all or
/// none, the first one last. So old and new files never exist together. Null pointers are skipped.
/// `check` is called between the steps.
void commit_all(
    std::span<const std::unique_ptr<OutputFile>> files,
    const std::function<void()>& remove_others = [] {}, const std::function<void()>& check = [] {});

}  // namespace eses::detail
