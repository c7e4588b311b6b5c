#pragma once
/// gzip (RFC 1952): members that stand behind each other in a file are read as one text.

#include <zlib.h>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace eses {

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

/// Whether a text begins as gzip's files do.
bool is_gzip(std::string_view bytes);

/// The text of all members. Throws Error, whose message begins with `name`, if they are damaged or
/// cut off.
std::string decompressed(std::string_view bytes, std::string_view name);

}  // namespace eses
