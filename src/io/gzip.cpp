#include "io/gzip.hpp"

#include <new>

namespace eses {

Gzip::Gzip() {
  constexpr int gzip_format = 16, largest_window = 15, usual_memory = 8;
  if (deflateInit2(&stream_, gzip_level, Z_DEFLATED, largest_window + gzip_format, usual_memory,
                   Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
}

Gzip::~Gzip() { deflateEnd(&stream_); }

std::span<const char> Gzip::member(std::span<const char> text) {
  deflateReset(&stream_);
  const uLong most = deflateBound(&stream_, static_cast<uLong>(text.size()));
  if (bytes_.size() < most) bytes_.resize(most);
  // zlib does not write to what it reads, though its interface does not say so.
  stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));  // NOLINT
  stream_.avail_in = static_cast<uInt>(text.size());
  stream_.next_out = reinterpret_cast<Bytef*>(bytes_.data());
  stream_.avail_out = static_cast<uInt>(bytes_.size());
  deflate(&stream_, Z_FINISH);  // into as much room as it may need: it always comes to the end
  return std::span(bytes_).first(bytes_.size() - stream_.avail_out);
}

}  // namespace eses
