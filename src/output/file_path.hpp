#pragma once
/// Paths of output files: symbolic links, names and rights, and files that are also read.

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace eses::detail {

/// A path divided into directory and name. std::filesystem::path is avoided for the reason given at
/// path_in.
struct FilePath {
  std::string directory, name;

  std::string text() const;
  bool operator==(const FilePath&) const = default;
};

/// The directory itself, or the nearest one above it that exists.
std::filesystem::path existing_part(std::filesystem::path directory);

/// Returns whether two directories are the same one, by their links or, if one does not exist yet,
/// by their names.
bool is_same_directory(const std::filesystem::path& a, const std::filesystem::path& b);

/// Follows symbolic links from `file` to the path where a file is to be written, so that the links
/// themselves are kept.
FilePath end_of_links(const std::filesystem::path& file);

/// Returns end_of_links of a file. Throws Error if this is in a directory that does not exist and
/// to which a link leads, or in one that is not writable, or if require_replaceable refuses it.
FilePath require_end_of_links(const std::filesystem::path& file);

/// Throws Error if no file can be created in a directory, which need not exist.
void require_writable(const std::filesystem::path& directory);

/// Throws Error if the file or its temporary file cannot have its name, or if require_replaceable
/// refuses it.
void require_free_name(const FilePath& path);

/// A file that a command reads.
struct ReadFile {
  std::filesystem::path path;  ///< `-` is standard input
  std::string role;            ///< for messages, such as `the input`
};

/// The files that a command reads. None of them is ever written, under whatever name.
class ReadFiles {
 public:
  /// Files that do not exist are ignored.
  explicit ReadFiles(std::span<const ReadFile> files);

  /// Throws Error if a path names one of the files, also by a symbolic or hard link. `fate` is what
  /// would happen to it.
  void refuse(const std::string& output,
              std::string_view fate = "overwritten; choose another name") const;

 private:
  std::map<std::pair<dev_t, ino_t>, std::string> roles_;  // by device and inode
};

}  // namespace eses::detail
