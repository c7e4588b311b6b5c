#pragma once
/// Reading of files as text, plain or gzipped, in parts or line by line. Except for read_text, the
/// memory does not grow with the file.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eses/check.hpp"
#include "system/bytes_text.hpp"
#include "system/file_descriptor.hpp"
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

/// Returns the name of an input file for messages: its path, or `<stdin>` for `-`.
std::string input_name(const std::filesystem::path& path);

/// Opens a file for reading and returns its descriptor. Throws Error with `name` in the message.
int open_for_reading(const std::filesystem::path& path, std::string_view name);

/// The text of a file. The file is treated as gzipped if its first two bytes are the magic
/// bytes of gzip, whatever its name. All members of a gzip file are read as one text (RFC 1952,
/// section 2.2). After the last member only zero bytes are accepted, as by `gzip -t`. Files of
/// other compression programs are refused by name.
class TextSource {
 public:
  /// Opens a file. Throws Error if that fails.
  explicit TextSource(const std::filesystem::path& path)
      : TextSource(FileDescriptor(open_for_reading(path, path.string())), path.string()) {}

  /// Opens an input file: standard input for `-`.
  static TextSource open_input(const std::filesystem::path& path);

  ~TextSource();
  TextSource(const TextSource&) = delete;
  TextSource& operator=(const TextSource&) = delete;

  /// Reads between one and `text.size()` characters, which must not be 0, and returns their number;
  /// returns 0 at the end of the text. Throws Error if the file cannot be read, or if compressed
  /// data is damaged or ends too early.
  std::size_t read(std::span<char> text);

  /// The name of the file for messages.
  const std::string& name() const { return name_; }

 private:
  struct Inflation;

  TextSource(FileDescriptor file, std::string name);

  void begin();
  std::size_t read_bytes(std::span<char> bytes);
  bool has_input();
  bool enter_member();
  std::size_t inflate_part(std::span<char> text);
  [[noreturn]] void fail_as_damaged() const;

  FileDescriptor file_;
  std::string name_;
  std::vector<char> buffer_;
  std::span<const char> input_;   // unused bytes of the buffer
  std::uint64_t bytes_read_ = 0;  // number of bytes read from the descriptor
  bool has_begun_ = false, is_in_member_ = false, is_padded_ = false;
  std::unique_ptr<Inflation> inflation_;  // null if the text is plain
};

/// Reads a whole text. Calls `check` for each MiB. Throws Error if the text has more than
/// `max_bytes`, or if its memory exceeds the limit.
std::string read_text(TextSource& source, const ReadingLimit& limit, const CheckCallback& check,
                      std::uint64_t max_bytes = std::numeric_limits<std::uint64_t>::max());

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
