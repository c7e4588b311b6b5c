#include "system/file_descriptor.hpp"

#include <linux/magic.h>
#include <sys/vfs.h>

#include <algorithm>
#include <array>
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

// Whether an error means that the kernel, the file system or a sandbox does not support the copy.
bool means_unsupported(int error) {
  constexpr std::array errors{EXDEV, EINVAL, ENOSYS, EOPNOTSUPP, EPERM};
  return std::find(errors.begin(), errors.end(), error) != errors.end();
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

std::uint64_t FileDescriptor::copy_from(int file, const CopyRange& range) const {
  auto from = static_cast<off64_t>(range.from), to = static_cast<off64_t>(range.to);
  return repeat(range.bytes, [&](std::size_t copied) {
    const ssize_t count = copy_file_range(file, &from, value_, &to, range.bytes - copied, 0);
    return count < 0 && means_unsupported(errno) ? 0 : count;
  });
}

bool FileDescriptor::is_in_local_file_system() const {
  constexpr unsigned long xfs = 0x58465342, zfs = 0x2FC12FC1;  // not in linux/magic.h everywhere
  constexpr std::array<unsigned long, 8> local{EXT4_SUPER_MAGIC,      xfs,        BTRFS_SUPER_MAGIC,
                                               TMPFS_MAGIC,           zfs,        F2FS_SUPER_MAGIC,
                                               OVERLAYFS_SUPER_MAGIC, RAMFS_MAGIC};
  struct statfs status {};
  if (fstatfs(value_, &status) != 0) return false;
  return std::find(local.begin(), local.end(), static_cast<unsigned long>(status.f_type)) !=
         local.end();
}

}  // namespace eses::detail
