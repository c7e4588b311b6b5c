#include "output/file_path.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <climits>
#include <optional>
#include <system_error>

#include "eses/error.hpp"
#include "output/file.hpp"
#include "output/output_directory.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

// Divides a path at its last slash.
FilePath divided(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos) return {".", path};
  return {slash == 0 ? "/" : path.substr(0, slash), path.substr(slash + 1)};
}

// Returns the target of a symbolic link, or nothing if `path` is not a symbolic link.
std::optional<std::string> target_of(const FilePath& path) {
  std::array<char, PATH_MAX> target{};
  const ssize_t length = readlink(path.text().c_str(), target.data(), target.size());
  if (length <= 0) return std::nullopt;
  std::string text(target.data(), static_cast<std::size_t>(length));
  return text.front() == '/' ? text : path_in(path.directory, text);
}

// Throws Error if `file` is a symbolic link into a directory that does not exist. Other missing
// directories are created, but this one may have been moved, or be on a disk that is not mounted.
void require_directory_of_link(const std::filesystem::path& file, const FilePath& end) {
  const bool is_link = target_of(divided(file.native())).has_value();
  struct stat status {};
  if (!is_link || stat(end.directory.c_str(), &status) == 0 || errno != ENOENT) return;
  throw Error(
      formatted("cannot write {}: it is a symbolic link into {}, which does not exist; create that "
                "directory, or remove the link",
                file.string(), end.directory));
}

}  // namespace

std::string FilePath::text() const { return path_in(directory, name); }

std::filesystem::path existing_part(std::filesystem::path directory) {
  std::error_code error;
  directory = std::filesystem::absolute(directory, error);
  while (!std::filesystem::exists(directory, error) && directory.has_relative_path())
    directory = directory.parent_path();
  return directory;
}

bool is_same_directory(const std::filesystem::path& a, const std::filesystem::path& b) {
  struct stat of_a {
  }, of_b{};
  if (stat(a.c_str(), &of_a) == 0 && stat(b.c_str(), &of_b) == 0)
    return of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
  const auto plain = [](const std::filesystem::path& path) {
    return (std::filesystem::absolute(path) / "").lexically_normal();
  };
  return plain(a) == plain(b);
}

FilePath end_of_links(const std::filesystem::path& file) {
  constexpr int max_links = 40;  // the limit of Linux
  FilePath path = divided(file.native());
  for (int i = 0; i < max_links; ++i) {
    const std::optional<std::string> target = target_of(path);
    if (!target) return path;
    path = divided(*target);
  }
  throw FileError(formatted("cannot write {}", file.string()), ELOOP);
}

FilePath require_end_of_links(const std::filesystem::path& file) {
  FilePath end = end_of_links(file);
  require_directory_of_link(file, end);
  // A device is refused by the name that the user gave, also where its directory is not writable.
  require_replaceable(file);
  require_writable(end.directory);
  return end;
}

// Uses faccessat with AT_EACCESS and not access(2), which checks the rights of the user who started
// the program instead of the rights of the process.
void require_writable(const std::filesystem::path& directory) {
  const std::filesystem::path existing = existing_part(directory);
  struct stat status {};
  int error = stat(existing.c_str(), &status) == 0 ? 0 : errno;
  if (error == 0 && !S_ISDIR(status.st_mode)) error = ENOTDIR;
  if (error == 0 && faccessat(AT_FDCWD, existing.c_str(), W_OK | X_OK, AT_EACCESS) != 0)
    error = errno;
  if (error != 0) throw FileError(formatted("cannot write into {}", directory.string()), error);
}

void require_free_name(const FilePath& path) {
  require_replaceable(path.text());
  struct stat status {};
  if (lstat(path.text().c_str(), &status) != 0 && errno == ENAMETOOLONG)
    throw Error(formatted("cannot create {}: {}", path.text(),
                          std::generic_category().message(ENAMETOOLONG)));
}

ReadFiles::ReadFiles(std::span<const ReadFile> files) {
  struct stat status {};
  for (const auto& [path, role] : files)
    if (stat(path == "-" ? "/dev/stdin" : path.c_str(), &status) == 0)
      roles_.emplace(std::pair(status.st_dev, status.st_ino), role);
}

void ReadFiles::refuse(const std::string& output, std::string_view fate) const {
  struct stat status {};
  if (stat(output.c_str(), &status) != 0) return;
  if (const auto found = roles_.find({status.st_dev, status.st_ino}); found != roles_.end())
    throw Error(formatted("{} is {}, and would be {}", output, found->second, fate));
}

}  // namespace eses::detail
