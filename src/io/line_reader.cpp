#include "io/line_reader.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <new>
#include <system_error>

#include "eses/error.hpp"
#include "io/text_fields.hpp"

namespace eses {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 18;
constexpr unsigned zlib_buffer_bytes = 1U << 16;
static_assert(longest_line < buffer_bytes);

[[noreturn]] void fail_with_system_error(std::string_view action, std::string_view name, int code) {
  if (code == ENOMEM) throw std::bad_alloc();
  throw Error(fmt::format("cannot {} {}: {}", action, name, std::generic_category().message(code)));
}

}  // namespace

LineReader::LineReader(const std::filesystem::path& path)
    : name_(path.string()), buffer_(buffer_bytes) {
  errno = 0;
  file_.reset(gzopen(path.c_str(), "rbe"));
  if (!file_) fail_with_system_error("open", name_, errno == 0 ? ENOMEM : errno);
  gzbuffer(file_.get(), zlib_buffer_bytes);
}

bool LineReader::next(std::string_view& line) {
  const auto find_end = [this] {
    return static_cast<const char*>(std::memchr(buffer_.data() + begin_, '\n', end_ - begin_));
  };
  const char* end = find_end();
  while (end == nullptr && !at_end_of_file_ && end_ - begin_ <= longest_line) {
    refill();
    end = find_end();
  }
  if (end == nullptr && begin_ == end_) return false;
  ++line_;
  const char* const begin = buffer_.data() + begin_;
  const std::size_t length = end == nullptr ? end_ - begin_ : static_cast<std::size_t>(end - begin);
  if (length > longest_line) fail(fmt::format("more than {} characters", longest_line));
  if (end == nullptr) fail("the line has no end; the file seems to be cut off");
  line = {begin, length};
  begin_ += length + 1;
  if (line.ends_with('\r')) line.remove_suffix(1);
  return true;
}

std::string_view LineReader::expect(std::string_view what) {
  std::string_view line;
  if (!next(line)) fail_at(line_ + 1, fmt::format("expected {}, found the end of the file", what));
  return line;
}

void LineReader::refill() {
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  errno = 0;
  const int count =
      gzread(file_.get(), buffer_.data() + end_, static_cast<unsigned>(buffer_.size() - end_));
  // Where compressed data ends too early, zlib hands out what there is and only then complains.
  int error = Z_OK;
  gzerror(file_.get(), &error);
  if (count < 0 || (count == 0 && error != Z_OK)) fail_to_read(error);
  end_ += static_cast<std::size_t>(count);
  at_end_of_file_ = count == 0;
}

void LineReader::fail(std::string_view what) const { fail_at(line_, what); }

void LineReader::fail_at(std::uint64_t line, std::string_view what) const {
  throw Error(fmt::format("{}:{}: {}", name_, line, what));
}

void LineReader::fail_to_read(int zlib_error) const {
  if (zlib_error == Z_MEM_ERROR) throw std::bad_alloc();
  if (zlib_error == Z_ERRNO) fail_with_system_error("read", name_, errno);
  fail_at(line_ + 1, zlib_error == Z_BUF_ERROR ? "the compressed data ends here, too early"
                                               : "the compressed data is damaged");
}

}  // namespace eses
