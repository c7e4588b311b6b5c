#include "memory_file.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <string>

#include "expect.hpp"

namespace eses::detail::fuzz {

MemoryFile::MemoryFile()
    : descriptor_(memfd_create("eses-fuzz", MFD_CLOEXEC)),
      path_("/proc/self/fd/" + std::to_string(descriptor_)) {
  expect(descriptor_ >= 0, "no file in memory");
}

MemoryFile::~MemoryFile() { close(descriptor_); }

void MemoryFile::assign(std::string_view bytes) const {
  const auto size = static_cast<ssize_t>(bytes.size());
  const bool written =
      ftruncate(descriptor_, 0) == 0 && pwrite(descriptor_, bytes.data(), bytes.size(), 0) == size;
  expect(written, "no room for a file in memory");
}

}  // namespace eses::detail::fuzz
