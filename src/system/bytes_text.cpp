#include "system/bytes_text.hpp"

#include <array>
#include <string_view>

#include "system/formatted.hpp"

namespace eses::detail {
namespace {

std::string in_units(std::uint64_t bytes, double step,
                     const std::array<std::string_view, 7>& units) {
  auto value = static_cast<double>(bytes);
  std::size_t unit = 0;
  // The format prints 999.5 as 1e+03, so that value already takes the next unit.
  for (; value >= 999.5 && unit + 1 < units.size(); ++unit) value /= step;
  return formatted("{:.3g} {}", value, units[unit]);
}

}  // namespace

std::string bytes_text(std::uint64_t bytes) {
  return in_units(bytes, 1000, {"B", "kB", "MB", "GB", "TB", "PB", "EB"});
}

std::string binary_bytes_text(std::uint64_t bytes) {
  return in_units(bytes, 1024, {"B", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"});
}

}  // namespace eses::detail
