#include "input/line_reader.hpp"

#include <algorithm>
#include <cstring>
#include <span>

#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

constexpr std::size_t line_buffer_bytes = std::size_t{1} << 18;
static_assert(max_line_length < line_buffer_bytes);

}  // namespace

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
