#include "parsed_atoms.hpp"

#include <cmath>
#include <cstddef>

#include "expect.hpp"

namespace eses::detail::fuzz {

ParsedAtoms parse(std::string_view text, AtomFormat format, const StructureOptions& options) {
  constexpr std::string_view name = "input";
  try {
    return {parse_atoms(text, format, name, options), {}};
  } catch (const Error& error) {
    return {{}, checked_message(error, name)};
  }
}

void expect_valid_atoms(const AtomFile& file) {
  constexpr double max_length = 1e6;  // angstrom
  expect(!file.atoms.empty(), "neither atoms nor an error");
  for (const auto& [center, radius] : file.atoms) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      expect(std::fabs(center[axis]) <= max_length, "a coordinate out of range");
    expect(radius >= 0 && radius <= max_length, "a radius out of range");
  }
}

}  // namespace eses::detail::fuzz
