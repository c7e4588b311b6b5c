#pragma once
/// Compression as gzip (RFC 1952).

#include <zlib.h>

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace eses::detail {

/// The end of the name of a compressed file.
inline constexpr std::string_view gzip_suffix = ".gz";

inline constexpr std::string_view gzip_magic = "\x1f\x8b";

/// Argument of deflateInit2 and inflateInit2: the largest window, plus 16 for the gzip format.
inline constexpr int gzip_window_bits = MAX_WBITS + 16;

/// The fastest level. Higher levels take more time than the computation and save little space.
inline constexpr int gzip_level = 1;

/// A reusable compressor. The bytes depend only on the text and on the version of zlib.
class Gzip {
 public:
  Gzip();
  ~Gzip();
  Gzip(const Gzip&) = delete;
  Gzip& operator=(const Gzip&) = delete;

  /// Compresses a text of less than 2 GB into one member, which is valid until the next call.
  std::span<const char> member(std::span<const char> text);

  /// Memory of zlib for one compressor, in bytes.
  static constexpr double state_bytes = 272 << 10;

 private:
  z_stream stream_{};
  std::vector<char> bytes_;
};

/// Returns whether a text starts with the magic bytes of gzip.
bool is_gzip(std::string_view bytes);

/// Returns `bytes` as input for zlib, which does not modify it.
Bytef* zlib_bytes(std::span<const char> bytes);

/// Returns the crc32 of bytes that follow others with the crc32 `before`.
std::uint32_t checksum(std::span<const char> bytes, std::uint32_t before = 0);

}  // namespace eses::detail
