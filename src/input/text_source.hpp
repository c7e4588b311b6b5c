#pragma once
/// Sequential reading of text, plain or gzipped. The memory does not grow with the file.

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
#include "input/reading_limit.hpp"
#include "system/file_descriptor.hpp"

namespace eses::detail {

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

}  // namespace eses::detail
