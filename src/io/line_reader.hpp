#pragma once
/// Text files, plain or gzipped, line by line, in memory that does not grow with the file.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/file_descriptor.hpp"
#include "io/text_source.hpp"

namespace eses::detail {

/// Lines of a file that TextSource reads. Every failure throws Error with the name of the file, and
/// with the number of the line where one is at fault.
class LineReader {
 public:
  explicit LineReader(const std::filesystem::path& path);

  /// The next line without its end, LF or CRLF, valid until the next call; false behind the last.
  /// A line without an end is refused: the file has been cut off.
  bool next(std::string_view& line);

  /// The next line, where there must be one; `what` tells what it should hold.
  std::string_view expect(std::string_view what);

  /// Throws Error about the line that was read last.
  [[noreturn]] void fail(std::string_view what) const;

 private:
  void refill();
  [[noreturn]] void fail_at(std::uint64_t line, std::string_view what) const;

  std::string name_;
  FileDescriptor file_;
  TextSource source_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;  // of what is in the buffer and not yet handed out
  bool at_end_of_file_ = false;
  std::uint64_t line_ = 0;  // 1-based number of the line that was read last
};

}  // namespace eses::detail
