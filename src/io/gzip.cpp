#include "io/gzip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "eses/error.hpp"

namespace eses {
namespace {

constexpr int gzip_format = 16, largest_window = 15;  // as zlib wants to be told

struct Inflation {
  z_stream stream{};

  Inflation() {
    if (inflateInit2(&stream, largest_window + gzip_format) != Z_OK) throw std::bad_alloc();
  }
  ~Inflation() { inflateEnd(&stream); }
  Inflation(const Inflation&) = delete;
  Inflation& operator=(const Inflation&) = delete;
};

// zlib does not write to what it reads, though its interface does not say so.
Bytef* input_of(std::span<const char> bytes) {
  return reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // NOLINT
}

// Appends the text of the member with which `bytes` begins, and tells its length.
std::size_t append_member(std::span<const char> bytes, std::string_view name, std::string& text) {
  constexpr std::size_t most_at_once = std::size_t{1} << 30, chunk = std::size_t{1} << 18;
  Inflation inflation;
  z_stream& stream = inflation.stream;
  std::size_t given = 0;
  for (int status = Z_OK; status != Z_STREAM_END;) {
    if (stream.avail_in == 0) {
      const auto part = bytes.subspan(given, std::min(most_at_once, bytes.size() - given));
      stream.next_in = input_of(part);
      stream.avail_in = static_cast<uInt>(part.size());
      given += part.size();
    }
    const std::size_t used = text.size();
    text.resize(used + chunk);
    stream.next_out = reinterpret_cast<Bytef*>(text.data() + used);
    stream.avail_out = chunk;
    status = inflate(&stream, Z_NO_FLUSH);
    text.resize(used + chunk - stream.avail_out);
    if (status == Z_MEM_ERROR) throw std::bad_alloc();
    if (status == Z_BUF_ERROR ||
        (status == Z_OK && stream.avail_in == 0 && given == bytes.size() && stream.avail_out > 0))
      throw Error(fmt::format("{}: the compressed data ends too early", name));
    if (status != Z_OK && status != Z_STREAM_END)
      throw Error(fmt::format("{}: the compressed data is damaged", name));
  }
  return given - stream.avail_in;
}

}  // namespace

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

std::string decompressed(std::string_view bytes, std::string_view name) {
  std::string text;
  // Behind the members there may be padding, which other programs pass over, too.
  while (is_gzip(bytes)) bytes.remove_prefix(append_member(bytes, name, text));
  return text;
}

Gzip::Gzip() {
  constexpr int usual_memory = 8;
  if (deflateInit2(&stream_, gzip_level, Z_DEFLATED, largest_window + gzip_format, usual_memory,
                   Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
}

Gzip::~Gzip() { deflateEnd(&stream_); }

std::span<const char> Gzip::member(std::span<const char> text) {
  deflateReset(&stream_);
  const uLong most = deflateBound(&stream_, static_cast<uLong>(text.size()));
  if (bytes_.size() < most) bytes_.resize(most);
  stream_.next_in = input_of(text);
  stream_.avail_in = static_cast<uInt>(text.size());
  stream_.next_out = reinterpret_cast<Bytef*>(bytes_.data());
  stream_.avail_out = static_cast<uInt>(bytes_.size());
  deflate(&stream_, Z_FINISH);  // into as much room as it may need: it always comes to the end
  return std::span(bytes_).first(bytes_.size() - stream_.avail_out);
}

}  // namespace eses
