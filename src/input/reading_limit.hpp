#pragma once
/// The memory limit while a file is read.

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include "system/bytes_text.hpp"
#include "system/formatted.hpp"
#include "system/hints.hpp"
#include "system/resources.hpp"

namespace eses::detail {

/// Keeps the resident memory within ReadOptions::max_memory; 0 for no limit.
class ReadingLimit {
 public:
  explicit ReadingLimit(std::uint64_t max_memory)
      : max_memory_(max_memory), max_resident_(resident_memory() + always_granted_bytes) {
    max_resident_ = std::max(max_memory_, max_resident_);
  }

  /// Throws Error if this number of additional bytes exceeds the limit. `reader` is the subject of
  /// the message.
  void require(std::uint64_t bytes, std::string_view reader) const {
    if (max_memory_ == 0 || resident_memory() + bytes <= max_resident_) return;
    throw LimitExceeded(formatted("{} exceeds the memory limit of {}; use a larger limit", reader,
                                  binary_bytes_text(max_memory_)));
  }

 private:
  // Memory that reading may always add to the memory of the process. A smaller limit is refused
  // later, by the plan, whose message names the smallest sufficient limit.
  static constexpr std::uint64_t always_granted_bytes = std::uint64_t{4} << 20;

  std::uint64_t max_memory_, max_resident_;
};

/// Returns the subject of messages about the memory for a whole file.
inline std::string reading_of(std::string_view file) {
  return formatted("{}: reading the file", file);
}

}  // namespace eses::detail
