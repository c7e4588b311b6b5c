#pragma once
/// Sequential output to files that one thread writes from beginning to end.

#include <cstdint>
#include <optional>
#include <span>

#include "output/eses_writer.hpp"
#include "output/output_file.hpp"
#include "system/gzip.hpp"

namespace eses::detail {

/// Appends parts to a file. In a gzip file each part is one member (RFC 1952).
class SequentialWriter {
 public:
  /// Keeps a reference to `file`.
  SequentialWriter(OutputFile& file, bool gzip) : file_(file) {
    if (gzip) gzip_.emplace();
  }

  void append(std::span<const char> text) {
    const std::span<const char> bytes = gzip_ ? gzip_->member(text) : text;
    file_.write_at(bytes, size_);
    size_ += bytes.size();
  }

  std::uint64_t size() const { return size_; }

 private:
  OutputFile& file_;
  std::optional<Gzip> gzip_;
  std::uint64_t size_ = 0;
};

/// Writes bounding_box.txt. Returns the number of bytes written.
inline std::uint64_t write_box(OutputFile& file, const Grid& grid, bool gzip) {
  SequentialWriter box(file, gzip);
  box.append(bounding_box_text(grid));
  return box.size();
}

}  // namespace eses::detail
