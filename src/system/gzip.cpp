#include "system/gzip.hpp"

#include <new>

namespace eses::detail {
// zlib does not modify its input, but its interface takes a pointer to non-const.
Bytef* zlib_bytes(std::span<const char> bytes) {
  return reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // NOLINT
}

std::uint32_t checksum(std::span<const char> bytes, std::uint32_t before) {
  // Without bytes, their address may be null, for which zlib returns the first value of a checksum.
  return bytes.empty()
             ? before
             : static_cast<std::uint32_t>(crc32_z(before, zlib_bytes(bytes), bytes.size()));
}

bool is_gzip(std::string_view bytes) { return bytes.starts_with(gzip_magic); }

Gzip::Gzip() {
  constexpr int usual_memory = 8;
  if (deflateInit2(&stream_, gzip_level, Z_DEFLATED, gzip_window_bits, usual_memory,
                   Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
}

Gzip::~Gzip() { deflateEnd(&stream_); }

std::span<const char> Gzip::member(std::span<const char> text) {
  deflateReset(&stream_);
  const uLong max_bytes = deflateBound(&stream_, static_cast<uLong>(text.size()));
  if (bytes_.size() < max_bytes) bytes_.resize(max_bytes);
  stream_.next_in = zlib_bytes(text);
  stream_.avail_in = static_cast<uInt>(text.size());
  stream_.next_out = reinterpret_cast<Bytef*>(bytes_.data());
  stream_.avail_out = static_cast<uInt>(bytes_.size());
  deflate(&stream_, Z_FINISH);  // completes in one call, as the buffer has deflateBound() bytes
  return std::span(bytes_).first(bytes_.size() - stream_.avail_out);
}

}  // namespace eses::detail
