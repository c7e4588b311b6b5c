#pragma once
/// A file in memory. The readers of ESES's files use zlib, which reads only files.

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

  /// Replaces the content of the file.
  void assign(std::string_view bytes) const;

 private:
  int descriptor_;
  std::filesystem::path path_;
};

}  // namespace eses::detail::fuzz
