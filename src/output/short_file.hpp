#pragma once
/// Text files that are written by one thread, part by part.

#include <cstdint>
#include <optional>
#include <span>

#include "io/eses_writer.hpp"
#include "io/gzip.hpp"
#include "output/output_file.hpp"

namespace eses {

/// Lines of partition_area.txt that are made, and compressed, at a time.
inline constexpr std::size_t area_lines_at_a_time = 1 << 16;

/// The parts of a file, one after the other, each a member of it if it is gzipped.
class ShortFile {
 public:
  /// Keeps a reference to `file`.
  ShortFile(OutputFile& file, bool gzip) : file_(file) {
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

/// Writes bounding_box.txt; returns its bytes.
inline std::uint64_t write_box(OutputFile& file, const Grid& grid, bool gzip) {
  ShortFile box(file, gzip);
  box.append(bounding_box_text(grid));
  return box.size();
}

}  // namespace eses
