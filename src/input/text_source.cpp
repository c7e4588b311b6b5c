#include "input/text_source.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <new>
#include <span>
#include <utility>

#include "eses/error.hpp"
#include "input/advice.hpp"
#include "input/text_fields.hpp"
#include "system/bytes_text.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"

namespace eses::detail {
namespace {

constexpr std::size_t source_buffer_bytes = std::size_t{1} << 16;

[[noreturn]] void fail_with_system_error(std::string_view action, std::string_view name, int code) {
  if (code == ENOMEM) throw std::bad_alloc();
  throw FileError(formatted("cannot {} {}", action, name), code);
}

/// A compressed format that is not read.
struct Compression {
  std::string_view magic;
  std::string_view name;
  std::string_view command;  ///< decompresses the file
};

// bzip2: the fourth byte is a digit from 1 to 9, the block size. xz:
// https://tukaani.org/xz/xz-file-format.txt. Zstandard: RFC 8878, section 3.1.1. ZIP: PKWARE's
// APPNOTE.TXT, section 4.3.7.
constexpr std::string_view bzip2_magic = "BZh";
constexpr std::array compressions{
    Compression{bzip2_magic, "bzip2", "bzip2 -d FILE"},
    Compression{{"\xfd"
                 "7zXZ\0",
                 6},
                "xz",
                "xz -d FILE"},
    Compression{"\x28\xb5\x2f\xfd", "Zstandard", "zstd -d FILE"},
    Compression{"PK\x03\x04", "ZIP", "unzip FILE"},
};

// The magic bytes of tar archives, POSIX.1-2017, section "pax".
constexpr std::string_view tar_magic = "ustar";
constexpr std::size_t tar_magic_begin = 257, max_magic_bytes = tar_magic_begin + tar_magic.size();

void refuse_other_compression(std::string_view bytes, std::string_view name) {
  for (const Compression& compression : compressions) {
    if (!bytes.starts_with(compression.magic)) continue;
    if (compression.magic == bzip2_magic && (bytes.size() < 4 || bytes[3] < '1' || bytes[3] > '9'))
      continue;
    throw Error(formatted("{}: {} files are not read; decompress the file, for example with `{}`",
                          name, compression.name, advice_for(name, compression.command)));
  }
}

void refuse_archive(std::string_view bytes, std::string_view name) {
  if (bytes.size() < max_magic_bytes || !bytes.substr(tar_magic_begin).starts_with(tar_magic))
    return;
  throw Error(
      formatted("{}: tar archives are not read; unpack it with `{}`, and choose a file of it", name,
                advice_for(name, "tar -xf FILE")));
}

constexpr std::size_t line_buffer_bytes = std::size_t{1} << 18;
static_assert(max_line_length < line_buffer_bytes);

}  // namespace

std::string input_name(const std::filesystem::path& path) {
  return path == "-" ? "<stdin>" : path.string();
}

int open_for_reading(const std::filesystem::path& path, std::string_view name) {
  int descriptor = -1;
  do {
    descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  } while (descriptor < 0 && errno == EINTR);
  if (descriptor < 0) fail_with_system_error("open", name, errno);
  return descriptor;
}

struct TextSource::Inflation {
  z_stream stream{};

  Inflation() {
    if (inflateInit2(&stream, gzip_window_bits) != Z_OK) throw std::bad_alloc();
  }
  ~Inflation() { inflateEnd(&stream); }
  Inflation(const Inflation&) = delete;
  Inflation& operator=(const Inflation&) = delete;
};

TextSource TextSource::open_input(const std::filesystem::path& path) {
  if (path != "-") return TextSource(path);
  return {FileDescriptor(::dup(STDIN_FILENO)), input_name(path)};
}

TextSource::TextSource(FileDescriptor file, std::string name)
    : file_(std::move(file)), name_(std::move(name)), buffer_(source_buffer_bytes) {}

TextSource::~TextSource() = default;

std::size_t TextSource::read(std::span<char> text) {
  if (!has_begun_) begin();
  if (!inflation_) {
    if (input_.empty()) return read_bytes(text);
    const std::size_t count = std::min(text.size(), input_.size());
    std::copy_n(input_.begin(), count, text.begin());
    input_ = input_.subspan(count);
    return count;
  }
  std::size_t count = 0;  // zlib may consume input without producing text
  while (count == 0 && enter_member()) count = inflate_part(text);
  const bool is_begin = inflation_->stream.total_out == count;
  if (is_begin) refuse_archive({text.data(), count}, name_);
  return count;
}

// Reads the magic bytes of compressed files. A pipe may deliver them one by one.
void TextSource::begin() {
  has_begun_ = true;
  std::size_t used = 0;
  for (std::size_t count = 1; count > 0 && used < max_magic_bytes; used += count)
    count = read_bytes(std::span(buffer_).subspan(used));
  input_ = std::span(buffer_).first(used);
  refuse_other_compression({buffer_.data(), used}, name_);
  refuse_archive({buffer_.data(), used}, name_);
  if (!is_gzip({buffer_.data(), used})) return;
  inflation_ = std::make_unique<Inflation>();
  is_in_member_ = true;
}

std::size_t TextSource::read_bytes(std::span<char> bytes) {
  ssize_t count = 0;
  do {
    count = ::read(file_.value(), bytes.data(), bytes.size());
  } while (count < 0 && errno == EINTR);
  if (count < 0) fail_with_system_error("read", name_, errno);
  bytes_read_ += static_cast<std::uint64_t>(count);
  return static_cast<std::size_t>(count);
}

// Refills the buffer if it is empty. Returns false at the end of the file.
bool TextSource::has_input() {
  if (input_.empty()) input_ = std::span(buffer_).first(read_bytes(buffer_));
  return !input_.empty();
}

// Enters the next member if the current one has ended. Returns false at the end of the file.
bool TextSource::enter_member() {
  while (!is_in_member_ && has_input()) {
    if (input_.front() == 0) {
      is_padded_ = true;
      input_ = input_.subspan(1);
      continue;
    }
    // zlib checks the rest of the header.
    if (is_padded_ || input_.front() != gzip_magic.front()) fail_as_damaged();
    inflateReset(&inflation_->stream);
    is_in_member_ = true;
  }
  return is_in_member_;
}

// Decompresses a part of the current member. Returns the number of characters.
std::size_t TextSource::inflate_part(std::span<char> text) {
  if (!has_input())
    throw Error(
        formatted("{}: the compressed data ends too early, after {} bytes", name_, bytes_read_));
  constexpr std::size_t max_at_once = std::size_t{1} << 30;  // zlib uses unsigned int for lengths
  const std::size_t room = std::min(text.size(), max_at_once);
  z_stream& stream = inflation_->stream;
  stream.next_in = zlib_bytes(input_);
  stream.avail_in = static_cast<uInt>(input_.size());
  stream.next_out = reinterpret_cast<Bytef*>(text.data());
  stream.avail_out = static_cast<uInt>(room);
  const int status = inflate(&stream, Z_NO_FLUSH);
  input_ = input_.last(stream.avail_in);
  if (status == Z_MEM_ERROR) throw std::bad_alloc();
  if (status != Z_OK && status != Z_STREAM_END) fail_as_damaged();
  is_in_member_ = status != Z_STREAM_END;
  return room - stream.avail_out;
}

void TextSource::fail_as_damaged() const {
  throw Error(formatted("{}: the compressed data is damaged near byte {}", name_,
                        bytes_read_ - input_.size()));
}

std::string read_text(TextSource& source, const ReadingLimit& limit, const CheckCallback& check,
                      std::uint64_t max_bytes) {
  std::string text;
  for (std::size_t used = 0;; used = text.size()) {
    if (check) check();
    // Pieces grow with the text, as resize() fills them: small files need small ones.
    const std::size_t piece_bytes = std::clamp(used, std::size_t{1} << 16, std::size_t{1} << 20);
    if (used + piece_bytes > text.capacity()) {
      // Both copies of the text are in memory while reserve() copies it.
      limit.require(used + 2 * (used + piece_bytes), reading_of(source.name()));
      text.reserve(2 * used + piece_bytes);
    }
    text.resize(used + piece_bytes);
    const std::size_t count = source.read(std::span(text).subspan(used));
    text.resize(used + count);
    if (count == 0) return text;
    if (text.size() > max_bytes)
      throw Error(
          formatted("{}: expected a file of at most {}", source.name(), bytes_text(max_bytes)));
  }
}

// ----------------------------------------------------------------------------------------- lines

LineReader::LineReader(const std::filesystem::path& path)
    : source_(path), buffer_(line_buffer_bytes) {}

bool LineReader::next(std::string_view& line) {
  const auto find_end = [this] {
    return static_cast<const char*>(std::memchr(buffer_.data() + begin_, '\n', end_ - begin_));
  };
  const char* end = find_end();
  while (end == nullptr && !at_end_of_file_ && end_ - begin_ <= max_line_length) {
    refill();
    end = find_end();
  }
  if (end == nullptr && begin_ == end_) return false;
  ++line_;
  const char* const begin = buffer_.data() + begin_;
  const std::size_t length = end == nullptr ? end_ - begin_ : static_cast<std::size_t>(end - begin);
  if (length > max_line_length && *begin == '#') {
    line = cut_comment();
    return true;
  }
  if (length > max_line_length) fail(formatted("more than {} characters", max_line_length));
  if (end == nullptr) fail("the line has no end; the file seems to be cut off");
  line = {begin, length};
  begin_ += length + 1;
  if (line.ends_with('\r')) line.remove_suffix(1);
  return true;
}

std::string_view LineReader::cut_comment() {
  comment_.assign(buffer_.data() + begin_, max_line_length);
  for (;;) {
    const std::string_view rest(buffer_.data() + begin_, end_ - begin_);
    const std::size_t end = rest.find('\n');
    begin_ += std::min(end, rest.size());
    if (end != rest.npos) break;
    refill();
    if (at_end_of_file_) fail("the line has no end; the file seems to be cut off");
  }
  ++begin_;
  return comment_;
}

bool LineReader::next_part(std::string_view& part) {
  if (end_ - begin_ <= max_line_length && !at_end_of_file_) refill();
  const std::string_view rest(buffer_.data() + begin_,
                              std::min(end_ - begin_, max_line_length + 1));
  if (rest.size() <= max_line_length || rest.find('\n') != rest.npos) {
    if (is_in_line_) --line_;  // next() counts it again
    is_in_line_ = false;
    return next(part);
  }
  const std::size_t blank = rest.find_last_of(" \t");
  if (!is_in_line_) ++line_;
  is_in_line_ = true;
  if (blank == rest.npos)
    fail(formatted("more than {} characters without a blank", max_line_length));
  part = rest.substr(0, blank + 1);
  begin_ += part.size();
  return true;
}

std::string_view LineReader::expect(std::string_view what) {
  std::string_view line;
  if (!next(line)) fail_at(line_ + 1, formatted("expected {}, found the end of the file", what));
  return line;
}

void LineReader::refill() {
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  const std::size_t count = source_.read(std::span(buffer_).subspan(end_));
  end_ += count;
  at_end_of_file_ = count == 0;
}

void LineReader::fail(std::string_view what) const { fail_at(line_, what); }

void LineReader::fail_at(std::uint64_t line, std::string_view what) const {
  fail_at_line(source_.name(), line, what);
}

}  // namespace eses::detail
