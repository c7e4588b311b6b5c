#include "output/file.hpp"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <vector>

#include "eses/error.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

std::filesystem::path temporary_directory() {
  std::error_code error;
  std::filesystem::path directory = std::filesystem::temp_directory_path(error);
  if (error) throw FileError("no directory for temporary files", error);
  return directory;
}

std::string temporary_file_in(const std::filesystem::path& directory) {
  return formatted("a temporary file in {}", directory.string());
}

const char* kind_of_file(mode_t mode) {
  if (S_ISDIR(mode)) return "a directory";
  if (S_ISCHR(mode)) return "a character device";
  if (S_ISBLK(mode)) return "a block device";
  if (S_ISFIFO(mode)) return "a FIFO";
  if (S_ISSOCK(mode)) return "a socket";
  return "a special file";
}

}  // namespace

void File::fail(const char* verb, int error) const {
  throw FileError(formatted("cannot {} {}", verb, name_), error);
}

void File::write_at(std::span<const char> bytes, std::uint64_t offset) try {
  file_.write_at(bytes, offset);
} catch (const std::system_error& error) {
  fail("write", error.code().value());
}

void File::append(std::span<const char> bytes) {
  write_at(bytes, appended_);
  appended_ += bytes.size();
}

std::uint64_t File::size() const {
  struct stat status {};
  if (fstat(file_.value(), &status) != 0) fail(read_, errno);
  return static_cast<std::uint64_t>(status.st_size);
}

void File::read_at(std::span<char> bytes, std::uint64_t offset) const try {
  // The file is shorter if another process has truncated it.
  if (file_.read_at(bytes, offset) < bytes.size()) fail(read_, EIO);
} catch (const std::system_error& error) {
  fail(read_, error.code().value());
}

void File::sync() {
  while (fsync(file_.value()) != 0)
    if (errno != EINTR) fail("write", errno);
}

ScratchFile::ScratchFile() : ScratchFile(temporary_directory()) {}

ScratchFile::ScratchFile(const std::filesystem::path& directory)
    : File(temporary_file_in(directory)) {
#ifdef O_TMPFILE
  file_ = FileDescriptor(open(directory.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600));
  if (file_.is_open()) return;
#endif
  // Some systems and file systems do not support O_TMPFILE.
  std::string path = directory.native() + "/.eses-blocks-XXXXXX";
  file_ = FileDescriptor(mkostemp(path.data(), O_CLOEXEC));
  if (!file_.is_open()) fail("create", errno);
  unlink(path.c_str());
}

ScratchFile::ScratchFile(const std::filesystem::path& directory, const std::string& name, Kept kept)
    : File(temporary_file_in(directory)) {
  const int mode = kept == Kept::fresh ? O_RDWR | O_CREAT | O_TRUNC : O_RDONLY;
  const std::string path = path_in(directory, name);
  file_ = FileDescriptor(open(path.c_str(), mode | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (!file_.is_open()) fail(kept == Kept::fresh ? "create" : "open", errno);
}

void copy_file(const File& from, std::uint64_t bytes, File& to, std::uint64_t begin,
               const std::function<void()>& check) {
  constexpr std::uint64_t bytes_per_read = 1 << 20;
  std::vector<char> part;
  for (std::uint64_t copied = 0; copied < bytes; copied += part.size()) {
    check();
    part.resize(std::min(bytes_per_read, bytes - copied));
    from.read_at(part, copied);
    to.write_at(part, begin + copied);
  }
}

void require_replaceable(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0 || S_ISREG(status.st_mode)) return;
  throw Error(formatted("cannot write {}: it is {}, not a regular file; choose another name", path,
                        kind_of_file(status.st_mode)));
}

OutputFile::OutputFile(const OutputDirectory& directory, std::string name)
    : File(path_in(directory.path(), name), "read back"),
      directory_(directory),
      name_(std::move(name)),
      temporary_name_(temporary_name(name_)) {
  require_replaceable(path());
  file_ = FileDescriptor(openat(directory_.descriptor(), temporary_name_.c_str(),
                                O_RDWR | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (!file_.is_open()) fail("create", errno);
  is_temporary_ = true;
}

OutputFile::~OutputFile() {
  if (is_temporary_) unlinkat(directory_.descriptor(), temporary_name_.c_str(), 0);
}

void OutputFile::close() {
  if (file_.close() != 0 && errno != EINTR) fail("write", errno);
}

void OutputFile::commit() {
  const int directory = directory_.descriptor();
  if (renameat(directory, temporary_name_.c_str(), directory, name_.c_str()) != 0)
    fail("rename the finished file to", errno);
  is_temporary_ = false;
  is_committed_ = true;
}

void OutputFile::withdraw() noexcept {
  if (is_committed_) unlinkat(directory_.descriptor(), name_.c_str(), 0);
}

void commit_all(std::span<const std::unique_ptr<OutputFile>> files,
                const std::function<void()>& remove_others, const std::function<void()>& check) {
  for (const auto& file : files) {
    if (!file) continue;
    file->close();
    check();
  }
  for (const auto& file : files)
    if (file) file->remove_older();
  remove_others();
  try {
    for (auto file = files.rbegin(); file != files.rend(); ++file) {
      if (!*file) continue;
      (*file)->commit();
      check();
    }
  } catch (...) {
    for (const auto& file : files)
      if (file) file->withdraw();
    throw;
  }
}

}  // namespace eses::detail
