#pragma once
/// Compression as gzip (RFC 1952).

#include <zlib.h>

#include <span>
#include <string_view>
#include <vector>

namespace eses::detail {

inline constexpr std::string_view gzip_magic = "\x1f\x8b";

/// What zlib is told of the format: the largest window, and 16 for gzip.
inline constexpr int gzip_window_bits = MAX_WBITS + 16;

/// Of the levels the fastest: the next ones take more time than the computation for little space.
inline constexpr int gzip_level = 1;

/// Compresses, again and again. The bytes depend on the text and on zlib's version alone.
class Gzip {
 public:
  Gzip();
  ~Gzip();
  Gzip(const Gzip&) = delete;
  Gzip& operator=(const Gzip&) = delete;

  /// `text`, of less than 2 GB, as one member; valid until the next call.
  std::span<const char> member(std::span<const char> text);

  /// Memory that zlib takes for one of these.
  static constexpr double state_bytes = 272 << 10;

 private:
  z_stream stream_{};
  std::vector<char> bytes_;
};

/// Whether a text begins as gzip files do.
bool is_gzip(std::string_view bytes);

/// `bytes` as the input of zlib, which only reads them.
Bytef* zlib_bytes(std::span<const char> bytes);

}  // namespace eses::detail
