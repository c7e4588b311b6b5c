#pragma once
/// Reading of text files, plain or gzipped, line by line. The memory does not grow with the file.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "input/text_source.hpp"

namespace eses::detail {

/// The lines of a file. All failures throw Error with the name of the file and, if a line is
/// faulty, with its number.
class LineReader {
 public:
  explicit LineReader(const std::filesystem::path& path);

  /// Reads the next line without its end, LF or CRLF. It is valid until the next call. Returns
  /// false at the end of the file. Throws Error for a last line without an end, as the file is
  /// truncated, and for a long line, unless it is a comment, which begins with #. Only the
  /// beginning of a long comment is returned.
  bool next(std::string_view& line);

  /// Reads the next line or, if it is long, its next part, which ends at a blank. Returns false at
  /// the end of the file.
  bool next_part(std::string_view& part);

  /// Returns the next line. Throws Error at the end of the file; `what` describes the expected
  /// line.
  std::string_view expect(std::string_view what);

  /// Throws Error with the number of the current line.
  [[noreturn]] void fail(std::string_view what) const;

 private:
  void refill();
  /// Returns the beginning of a comment, and skips the rest of it.
  std::string_view cut_comment();
  [[noreturn]] void fail_at(std::uint64_t line, std::string_view what) const;

  TextSource source_;
  std::vector<char> buffer_;
  std::string comment_;              // the beginning of a long comment
  std::size_t begin_ = 0, end_ = 0;  // the unread part of the buffer
  bool at_end_of_file_ = false, is_in_line_ = false;
  std::uint64_t line_ = 0;  // number of the current line, from 1
};

}  // namespace eses::detail
