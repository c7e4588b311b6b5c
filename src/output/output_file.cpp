#include "output/output_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "eses/error.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

const char* kind_of_file(mode_t mode) {
  if (S_ISDIR(mode)) return "a directory";
  if (S_ISCHR(mode)) return "a character device";
  if (S_ISBLK(mode)) return "a block device";
  if (S_ISFIFO(mode)) return "a FIFO";
  if (S_ISSOCK(mode)) return "a socket";
  return "a special file";
}

}  // namespace

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
