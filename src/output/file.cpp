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
#include "output/output_directory.hpp"
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
  file_ = FileDescriptor(open(directory.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600));
  if (file_.is_open()) return;
  // Some file systems do not support O_TMPFILE.
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

}  // namespace eses::detail
