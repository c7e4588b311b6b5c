#include "output/vertex_color.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace eses::detail::mesh {

Color patch_color(std::uint8_t patch) {
  constexpr Color convex{86, 180, 233}, saddle{240, 228, 66}, concave{213, 94, 0};
  return patch == 1 ? convex : patch == 2 ? saddle : concave;
}

// The hue of a number is the fractional part of its product with the golden ratio, whose multiples
// are evenly distributed. Integer arithmetic gives the same result on all machines.
Color distinct_color(std::uint64_t number) {
  constexpr std::uint64_t golden = 0x9E3779B9, low = 60, high = 235;
  const std::uint64_t hue = 6 * (number * golden & 0xFFFFFFFF);  // in sixths of 2^32
  const std::uint64_t rise = (hue & 0xFFFFFFFF) * (high - low) >> 32;
  const auto up = static_cast<std::uint8_t>(low + rise);
  const auto down = static_cast<std::uint8_t>(high - rise);
  constexpr auto none = static_cast<std::uint8_t>(low), full = static_cast<std::uint8_t>(high);
  const std::array<Color, 6> sixths{{{full, up, none},
                                     {down, full, none},
                                     {none, full, up},
                                     {none, down, full},
                                     {up, none, full},
                                     {full, none, down}}};
  return sixths[hue >> 32];
}

// The colours are those of scripts/eses_tools/pages/viewer/data.js.
Color component_color(std::uint32_t component) {
  constexpr Color outside{200, 200, 200};
  return component == 0 ? outside : distinct_color(component - 1);
}

// The colours are those of scripts/eses_tools/page.py.
Color potential_color(double potential, double limit) {
  constexpr std::array<std::array<double, 3>, 5> stops{
      {{200, 20, 30}, {245, 160, 140}, {248, 248, 248}, {140, 170, 245}, {25, 50, 205}}};
  constexpr std::size_t last = stops.size() - 1;
  const double at = std::clamp(0.5 + potential / (2 * limit), 0.0, 1.0) * double{last};
  const std::size_t low = std::min(static_cast<std::size_t>(at), last - 1);
  const double fraction = at - static_cast<double>(low);
  Color color{};
  for (std::size_t part = 0; part < color.size(); ++part)
    color[part] = static_cast<std::uint8_t>(
        std::lround(std::lerp(stops[low][part], stops[low + 1][part], fraction)));
  return color;
}

}  // namespace eses::detail::mesh
