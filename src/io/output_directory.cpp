#include "io/output_directory.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <cerrno>
#include <memory>
#include <string_view>
#include <system_error>
#include <utility>

#include "eses/error.hpp"

namespace eses {
namespace {

constexpr char lock_name[] = ".eses-blocks.lock";
constexpr std::string_view temporary_suffix = ".part";

[[noreturn]] void refuse(const std::filesystem::path& directory, const std::string& reason) {
  throw Error(fmt::format("cannot write into {}: {}", directory.string(), reason));
}

[[noreturn]] void refuse(const std::filesystem::path& directory, int error) {
  refuse(directory, std::generic_category().message(error));
}

FileDescriptor open_directory(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) refuse(path, error.message());
  FileDescriptor directory(open(path.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (!directory.is_open()) refuse(path, errno);
  return directory;
}

FileDescriptor open_lock(const FileDescriptor& directory) {
  constexpr int flags = O_NOFOLLOW | O_CLOEXEC;
  FileDescriptor lock(openat(directory.value(), lock_name, O_RDWR | O_CREAT | flags, 0666));
  // Another user's run may have left it; to read is enough for locks, but on NFS.
  if (!lock.is_open() && errno == EACCES) {
    lock = FileDescriptor(openat(directory.value(), lock_name, O_RDONLY | flags));
    if (!lock.is_open()) errno = EACCES;
  }
  return lock;
}

bool is_same_file(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

// Whoever had the lock may have removed its file after it was opened here.
bool is_still_there(const FileDescriptor& directory, const FileDescriptor& lock) {
  struct stat opened {
  }, named{};
  return fstat(lock.value(), &opened) == 0 &&
         fstatat(directory.value(), lock_name, &named, AT_SYMLINK_NOFOLLOW) == 0 &&
         is_same_file(opened, named);
}

struct CloseDirectory {
  void operator()(DIR* directory) const { closedir(directory); }
};

// The name under which a temporary file would have appeared, or nothing if it is no such file.
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

std::string lock_path(const std::filesystem::path& directory) {
  return path_in(directory, lock_name);
}

std::string path_in(const std::filesystem::path& directory, const std::string& name) {
  return fmt::format("{}/{}", directory.native(), name);
}

std::string temporary_name(const std::string& name, long process) {
  return fmt::format(".{}.{}{}", name, process, temporary_suffix);
}

OutputDirectory::OutputDirectory(std::filesystem::path path)
    : path_(std::move(path)), directory_(open_directory(path_)) {
  lock();
}

OutputDirectory::~OutputDirectory() {
  if (is_locked_) unlinkat(descriptor(), lock_name, 0);
}

bool OutputDirectory::is_at(const std::string& other) const {
  struct stat here {
  }, there{};
  return fstat(descriptor(), &here) == 0 && stat(other.c_str(), &there) == 0 &&
         is_same_file(here, there);
}

void OutputDirectory::lock() {
  while (!try_lock()) {
  }
}

// False if the lock's file was removed in the meantime.
bool OutputDirectory::try_lock() {
  lock_ = open_lock(directory_);
  if (!lock_.is_open()) refuse(path_, errno);
  if (flock(lock_.value(), LOCK_EX | LOCK_NB) == 0) {
    is_locked_ = is_still_there(directory_, lock_);
    return is_locked_;
  }
  if (errno == EWOULDBLOCK) refuse(path_, "another run is writing there");
  return true;  // a file system without locks
}

void OutputDirectory::remove_abandoned(
    const std::function<bool(std::string_view name)>& is_ours) const {
  if (!is_locked_) return;
  // Not std::filesystem's iterator: it ends the process where memory runs out.
  const int readable = openat(descriptor(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const std::unique_ptr<DIR, CloseDirectory> listing(readable < 0 ? nullptr : fdopendir(readable));
  if (!listing) return;
  while (const dirent* const entry = readdir(listing.get()))
    if (is_ours(final_name(entry->d_name))) unlinkat(descriptor(), entry->d_name, 0);
}

void OutputDirectory::remove(const std::string& name) const {
  if (unlinkat(descriptor(), name.c_str(), 0) == 0 || errno == ENOENT) return;
  throw Error(fmt::format("cannot replace {}: {}", path_in(path_, name),
                          std::generic_category().message(errno)));
}

}  // namespace eses
