#pragma once
/// A file in memory: zlib, by which ESES's files are read, takes files only.

#include <filesystem>
#include <string_view>

namespace eses::detail::fuzz {

class MemoryFile {
 public:
  MemoryFile();
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Replaces what the file holds.
  void assign(std::string_view bytes) const;

 private:
  int descriptor_;
  std::filesystem::path path_;
};

}  // namespace eses::detail::fuzz
