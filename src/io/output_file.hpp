#pragma once
/// Files that are complete or absent.

#include <cstdint>
#include <filesystem>
#include <span>

namespace eses {

/// A file that is written under a temporary name in its own directory, and gets its final name only
/// by `commit`. Destroyed before that, it leaves nothing behind. Every failure throws Error, naming
/// the file.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path final_path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// May be called from several threads for disjoint ranges.
  void write_at(std::span<const char> bytes, std::uint64_t offset);
  /// Checks what the system reports only at the end; nothing can be written after it.
  void close();
  /// Renames the closed file, replacing any older one.
  void commit();
  /// Removes the committed file again.
  void withdraw() noexcept;

 private:
  std::filesystem::path final_path_, temporary_path_;
  int descriptor_ = -1;
  bool is_temporary_ = false;
};

}  // namespace eses
