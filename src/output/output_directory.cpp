#include "output/output_directory.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdint>
#include <memory>
#include <system_error>

#include "eses/error.hpp"
#include "system/formatted.hpp"
#include "system/splitmix64.hpp"

namespace eses::detail {
namespace {

constexpr std::string_view lock_name = ".eses-blocks.lock";
constexpr std::string_view temporary_suffix = ".part";

// Opens a directory that need not be readable, because only names in it are used.
#ifdef O_PATH
constexpr int names_only = O_PATH;
#else
constexpr int names_only = O_SEARCH;
#endif

// Returns the beginning of a message.
std::string refusal(const std::filesystem::path& directory) {
  return formatted("cannot write into {}", directory.string());
}

FileDescriptor open_directory(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw FileError(refusal(path), error);
  FileDescriptor directory(open(path.c_str(), names_only | O_DIRECTORY | O_CLOEXEC));
  if (!directory.is_open()) throw FileError(refusal(path), errno);
  return directory;
}

// Returns the part of hidden names that stands for a file. Long names are shortened, so that
// temporary files and locks have at most 255 bytes, the limit of Linux. The end of the name is
// kept.
std::string hidden_stem(const std::string& name) {
  constexpr std::size_t max_size = 220, start = 170, end = 24;
  if (name.size() <= max_size) return name;
  std::uint64_t hash = name.size();
  for (const char c : name) hash = splitmix64(hash ^ static_cast<unsigned char>(c));
  return formatted("{}~{:016x}{}", name.substr(0, start), hash, name.substr(name.size() - end));
}

std::string hidden_name(const std::string& file, std::string_view suffix) {
  return file.empty() ? std::string(suffix) : formatted(".{}{}", hidden_stem(file), suffix);
}

FileDescriptor open_lock(const FileDescriptor& directory, const std::string& name) {
  constexpr int flags = O_NOFOLLOW | O_CLOEXEC;
  FileDescriptor lock(openat(directory.value(), name.c_str(), O_RDWR | O_CREAT | flags, 0666));
  // A run of another user may have left the file, so that it is only readable. Except on NFS, a
  // lock does not need the right to write.
  if (!lock.is_open() && errno == EACCES) {
    lock = FileDescriptor(openat(directory.value(), name.c_str(), O_RDONLY | flags));
    if (!lock.is_open()) errno = EACCES;
  }
  return lock;
}

// Whether `lock` is still the file of this name. The run that held the lock may have removed the
// file after it was opened here.
bool is_still_there(const FileDescriptor& directory, const FileDescriptor& lock,
                    const std::string& name) {
  struct stat opened {
  }, named{};
  return fstat(lock.value(), &opened) == 0 &&
         fstatat(directory.value(), name.c_str(), &named, AT_SYMLINK_NOFOLLOW) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

struct CloseDirectory {
  void operator()(DIR* directory) const { closedir(directory); }
};

// Returns the final name of a temporary file, or an empty string for other names.
std::string_view final_name(std::string_view file) {
  if (!file.starts_with('.') || !file.ends_with(temporary_suffix)) return {};
  file.remove_prefix(1);
  file.remove_suffix(temporary_suffix.size());
  const std::size_t dot = file.rfind('.');
  const bool has_process = dot != file.npos && dot + 1 < file.size() &&
                           file.find_first_not_of("0123456789", dot + 1) == file.npos;
  return has_process ? file.substr(0, dot) : std::string_view();
}

}  // namespace

std::string hidden_path(const std::filesystem::path& directory, const std::string& file,
                        std::string_view suffix) {
  return path_in(directory, hidden_name(file, suffix));
}

std::string lock_path(const std::filesystem::path& directory, const std::string& file) {
  return hidden_path(directory, file, lock_name);
}

std::string path_in(const std::filesystem::path& directory, const std::string& name) {
  return formatted("{}/{}", directory.native(), name);
}

std::string temporary_name(const std::string& name) {
  return formatted(".{}.{}{}", hidden_stem(name), getpid(), temporary_suffix);
}

void OutputPaths::add(const std::filesystem::path& directory, const std::string& name) {
  final.push_back(path_in(directory, name));
  temporaries.push_back(path_in(directory, temporary_name(name)));
}

OutputDirectory::OutputDirectory(std::filesystem::path path, std::string file, Access access)
    : path_(std::move(path)),
      file_(std::move(file)),
      lock_name_(hidden_name(file_, lock_name)),
      access_(access),
      directory_(open_directory(path_)) {
  while (!try_lock()) {
  }
  if (!file_.empty())
    remove_abandoned([stem = hidden_stem(file_)](std::string_view name) { return name == stem; });
}

// The file of a shared lock stays, as the other runs that hold the lock have it open.
OutputDirectory::~OutputDirectory() {
  if (is_locked_ && access_ == Access::exclusive) unlinkat(descriptor(), lock_name_.c_str(), 0);
}

// Returns false if the lock's file was removed in the meantime.
bool OutputDirectory::try_lock() {
  lock_ = open_lock(directory_, lock_name_);
  if (!lock_.is_open()) throw FileError(refusal(path_), errno);
  const int operation = access_ == Access::exclusive ? LOCK_EX : LOCK_SH;
  if (flock(lock_.value(), operation | LOCK_NB) == 0) {
    is_locked_ = is_still_there(directory_, lock_, lock_name_);
    return is_locked_;
  }
  if (errno == EWOULDBLOCK && file_.empty())
    throw Error(refusal(path_) + ": another run is writing there");
  if (errno == EWOULDBLOCK)
    throw Error(formatted("cannot write {}: another run is writing it", path_in(path_, file_)));
  return true;  // The file system has no locks.
}

void OutputDirectory::remove_abandoned(
    const std::function<bool(std::string_view name)>& is_ours) const {
  if (!is_locked_) return;
  // std::filesystem::directory_iterator terminates the process when memory runs out.
  const int readable = openat(descriptor(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const std::unique_ptr<DIR, CloseDirectory> listing(readable < 0 ? nullptr : fdopendir(readable));
  if (!listing) return;
  while (const dirent* const entry = readdir(listing.get()))
    if (is_ours(final_name(entry->d_name))) unlinkat(descriptor(), entry->d_name, 0);
}

void OutputDirectory::remove(const std::string& name) const {
  if (unlinkat(descriptor(), name.c_str(), 0) == 0 || errno == ENOENT) return;
  throw FileError(formatted("cannot replace {}", path_in(path_, name)), errno);
}

}  // namespace eses::detail
