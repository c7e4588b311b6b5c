#include "system/file_descriptor.hpp"

#include <cerrno>
#include <system_error>

namespace eses::detail {
namespace {

// Calls `transfer(begin)` with the number of bytes that are transferred, until all `size` bytes
// are, or until it returns 0. Returns the number of transferred bytes.
template <class Transfer>
std::size_t repeat(std::size_t size, Transfer&& transfer) {
  std::size_t transferred = 0;
  while (transferred < size) {
    const ssize_t count = transfer(transferred);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw std::system_error(errno, std::generic_category());
    if (count == 0) break;
    transferred += static_cast<std::size_t>(count);
  }
  return transferred;
}

}  // namespace

std::size_t FileDescriptor::read_at(std::span<char> bytes, std::uint64_t offset) const {
  return repeat(bytes.size(), [&](std::size_t begin) {
    return pread(value_, bytes.data() + begin, bytes.size() - begin,
                 static_cast<off_t>(offset + begin));
  });
}

void FileDescriptor::write_at(std::span<const char> bytes, std::uint64_t offset) const {
  const std::size_t written = repeat(bytes.size(), [&](std::size_t begin) {
    return pwrite(value_, bytes.data() + begin, bytes.size() - begin,
                  static_cast<off_t>(offset + begin));
  });
  if (written < bytes.size()) throw std::system_error(EIO, std::generic_category());
}

}  // namespace eses::detail
