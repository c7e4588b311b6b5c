#include "output/kernel_copy.hpp"

#include <linux/magic.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

namespace eses::detail {
namespace {

// Whether an error means that the kernel, the file system or a sandbox does not support the copy.
bool means_unsupported(int error) {
  constexpr std::array errors{EXDEV, EINVAL, ENOSYS, EOPNOTSUPP, EPERM};
  return std::find(errors.begin(), errors.end(), error) != errors.end();
}

}  // namespace

std::uint64_t copy_in_kernel(int from, int to, const CopyRange& range) {
  auto from_offset = static_cast<off64_t>(range.from), to_offset = static_cast<off64_t>(range.to);
  std::uint64_t copied = 0;
  while (copied < range.bytes) {
    const ssize_t count =
        copy_file_range(from, &from_offset, to, &to_offset, range.bytes - copied, 0);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && !means_unsupported(errno))
      throw std::system_error(errno, std::generic_category());
    if (count <= 0) break;
    copied += static_cast<std::uint64_t>(count);
  }
  return copied;
}

bool is_in_local_file_system(int file) {
  constexpr unsigned long xfs = 0x58465342, zfs = 0x2FC12FC1;  // not in linux/magic.h everywhere
  constexpr std::array<unsigned long, 8> local{EXT4_SUPER_MAGIC,      xfs,        BTRFS_SUPER_MAGIC,
                                               TMPFS_MAGIC,           zfs,        F2FS_SUPER_MAGIC,
                                               OVERLAYFS_SUPER_MAGIC, RAMFS_MAGIC};
  struct statfs status {};
  if (fstatfs(file, &status) != 0) return false;
  return std::find(local.begin(), local.end(), static_cast<unsigned long>(status.f_type)) !=
         local.end();
}

}  // namespace eses::detail
