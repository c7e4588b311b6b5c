#pragma once
/// A file for what memory should not hold.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace eses::detail {

/// A file without a name, gone with the object or the process, unless it is to stay. Every failure
/// throws Error, naming the file's directory.
class ScratchFile {
 public:
  /// In the directory for temporary files (TMPDIR, or /tmp).
  ScratchFile();
  explicit ScratchFile(std::filesystem::path directory);
  /// One that has a name and stays: empty, or as it was left.
  enum class Kept { fresh, existing };
  ScratchFile(std::filesystem::path directory, const std::string& name, Kept kept);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  void append(std::span<const std::byte> bytes);
  /// May be called from several threads for disjoint ranges; `size` does not count it.
  void write_at(std::span<const std::byte> bytes, std::uint64_t offset);
  /// All of `bytes`, which must have been written.
  void read_at(std::span<std::byte> bytes, std::uint64_t offset) const;
  /// Open while this lives.
  int descriptor() const { return descriptor_; }
  /// Waits until everything is on the disk.
  void sync();
  /// Of what was appended.
  std::uint64_t size() const { return size_; }

 private:
  std::filesystem::path directory_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace eses::detail
