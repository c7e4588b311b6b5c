#include "io/output_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "eses/error.hpp"

namespace eses {
namespace {

[[noreturn]] void fail(const char* action, const std::filesystem::path& path, int error) {
  throw Error(fmt::format("cannot {} {}: {}", action, path.string(), std::strerror(error)));
}

}  // namespace

OutputFile::OutputFile(std::filesystem::path final_path)
    : final_path_(std::move(final_path)),
      temporary_path_(final_path_.parent_path() /
                      fmt::format(".{}.{}.part", final_path_.filename().string(), getpid())) {
  std::error_code ignored;
  if (std::filesystem::is_directory(final_path_, ignored)) fail("create", final_path_, EISDIR);
  descriptor_ = open(temporary_path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail("create", final_path_, errno);
  is_temporary_ = true;
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (is_temporary_) unlink(temporary_path_.c_str());
}

void OutputFile::write_at(std::span<const char> bytes, std::uint64_t offset) {
  while (!bytes.empty()) {
    const ssize_t written =
        pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write", final_path_, errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
}

void OutputFile::close() {
  const int result = ::close(std::exchange(descriptor_, -1));
  if (result != 0 && errno != EINTR) fail("write", final_path_, errno);
}

void OutputFile::commit() {
  if (std::rename(temporary_path_.c_str(), final_path_.c_str()) != 0)
    fail("rename the finished file to", final_path_, errno);
  is_temporary_ = false;
}

void OutputFile::withdraw() noexcept { unlink(final_path_.c_str()); }

}  // namespace eses
