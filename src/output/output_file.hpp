#pragma once
/// Files that are complete or absent.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "output/kernel_copy.hpp"
#include "output/output_directory.hpp"

namespace eses::detail {

/// Throws Error if `path` leads, perhaps by symbolic links, to something that a regular file must
/// not replace: a directory, device, FIFO or socket.
void require_replaceable(const std::string& path);

/// A file that is written under a temporary name in its own directory, and gets its final name only
/// by `commit`. Destroyed before that, it leaves nothing behind. Every failure throws Error, naming
/// the file.
class OutputFile {
 public:
  /// Keeps a reference to `directory`, which must outlive the file. Throws Error as
  /// require_replaceable does.
  OutputFile(const OutputDirectory& directory, std::string name);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Where it is in the end, and for now.
  std::string path() const { return path_in(directory_.path(), name_); }
  std::string temporary_path() const { return path_in(directory_.path(), temporary_name_); }

  /// May be called from several threads for disjoint ranges.
  void write_at(std::span<const char> bytes, std::uint64_t offset);
  /// Copies a range of another open file, as copy_in_kernel does.
  std::uint64_t copy_from(int file, const CopyRange& range);
  /// Reads what has been written there before; bytes that nobody wrote are 0.
  void read_at(std::span<char> bytes, std::uint64_t offset);
  /// Cuts off what is behind the first `bytes`.
  void truncate(std::uint64_t bytes);
  /// Checks what the system reports only at the end; nothing can be written after it.
  void close();
  /// Removes an older file of the name, if there is one.
  void remove_older();
  /// Renames the closed file, replacing any older one.
  void commit();
  /// Removes the file again if it was committed.
  void withdraw() noexcept;

 private:
  [[noreturn]] void fail(const char* action, int error) const;

  const OutputDirectory& directory_;
  std::string name_, temporary_name_;
  FileDescriptor file_;
  bool is_temporary_ = false, is_committed_ = false;
};

}  // namespace eses::detail
