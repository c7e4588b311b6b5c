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
  descriptor_ = open(directory_.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor_ >= 0) return;
  // Some file systems do not support O_TMPFILE.
  std::string name = directory_.native() + "/.eses-blocks-XXXXXX";
  descriptor_ = mkostemp(name.data(), O_CLOEXEC);
  if (descriptor_ < 0) fail("create", directory_, errno);
  unlink(name.c_str());
}

ScratchFile::ScratchFile(std::filesystem::path directory, const std::string& name, Kept kept)
    : directory_(std::move(directory)) {
  const int mode = kept == Kept::fresh ? O_RDWR | O_CREAT | O_TRUNC : O_RDONLY;
  descriptor_ = open(path_in(directory_, name).c_str(), mode | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail(kept == Kept::fresh ? "create" : "open", directory_, errno);
}

ScratchFile::~ScratchFile() { close(descriptor_); }

void ScratchFile::append(std::span<const std::byte> bytes) {
  write_at(bytes, size_);
  size_ += bytes.size();
}

void ScratchFile::write_at(std::span<const std::byte> bytes, std::uint64_t offset) {
  while (!bytes.empty()) {
    const ssize_t written =
        pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write", directory_, errno);
    if (written == 0) fail("write", directory_, EIO);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
}

void ScratchFile::read_at(std::span<std::byte> bytes, std::uint64_t offset) const {
  while (!bytes.empty()) {
    const ssize_t count =
        pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail("read", directory_, count < 0 ? errno : EIO);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    offset += static_cast<std::uint64_t>(count);
  }
}

void ScratchFile::sync() {
  while (fsync(descriptor_) != 0)
    if (errno != EINTR) fail("write", directory_, errno);
}

}  // namespace eses::detail
