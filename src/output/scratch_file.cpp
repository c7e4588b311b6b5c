#include "output/scratch_file.hpp"

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "eses/error.hpp"
#include "output/output_directory.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

[[noreturn]] void fail(const char* action, const std::filesystem::path& directory, int error) {
  throw FileError(formatted("cannot {} a temporary file in {}", action, directory.string()), error);
}

std::filesystem::path temporary_directory() {
  std::error_code error;
  std::filesystem::path directory = std::filesystem::temp_directory_path(error);
  if (error) throw FileError("no directory for temporary files", error);
  return directory;
}

}  // namespace

ScratchFile::ScratchFile() : ScratchFile(temporary_directory()) {}

ScratchFile::ScratchFile(std::filesystem::path directory) : directory_(std::move(directory)) {
  file_ = FileDescriptor(open(directory_.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600));
  if (file_.is_open()) return;
  // Some file systems do not support O_TMPFILE.
  std::string name = directory_.native() + "/.eses-blocks-XXXXXX";
  file_ = FileDescriptor(mkostemp(name.data(), O_CLOEXEC));
  if (!file_.is_open()) fail("create", directory_, errno);
  unlink(name.c_str());
}

ScratchFile::ScratchFile(std::filesystem::path directory, const std::string& name, Kept kept)
    : directory_(std::move(directory)) {
  const int mode = kept == Kept::fresh ? O_RDWR | O_CREAT | O_TRUNC : O_RDONLY;
  file_ =
      FileDescriptor(open(path_in(directory_, name).c_str(), mode | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (!file_.is_open()) fail(kept == Kept::fresh ? "create" : "open", directory_, errno);
}

void ScratchFile::append(std::span<const std::byte> bytes) {
  write_at(bytes, size_);
  size_ += bytes.size();
}

void ScratchFile::write_at(std::span<const std::byte> bytes, std::uint64_t offset) try {
  file_.write_at({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, offset);
} catch (const std::system_error& error) {
  fail("write", directory_, error.code().value());
}

void ScratchFile::read_at(std::span<std::byte> bytes, std::uint64_t offset) const try {
  if (file_.read_at({reinterpret_cast<char*>(bytes.data()), bytes.size()}, offset) < bytes.size())
    fail("read", directory_, EIO);
} catch (const std::system_error& error) {
  fail("read", directory_, error.code().value());
}

void ScratchFile::sync() {
  while (fsync(file_.value()) != 0)
    if (errno != EINTR) fail("write", directory_, errno);
}

}  // namespace eses::detail
