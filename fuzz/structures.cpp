/// Fuzzes the reader of PDB and mmCIF files, for the format that the build chooses. For any text
/// the reader returns atoms with position, radius, line and label, or a well-formed error message.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "eses/read_atoms.hpp"
#include "expect.hpp"

namespace eses::detail::fuzz {
namespace {

constexpr AtomFormat format = AtomFormat::ESES_FUZZ_FORMAT;
constexpr std::string_view name = "input";
constexpr double max_length = 1e6;  // angstrom

/// The atoms, or the error message if there are none.
struct Outcome {
  AtomFile file;
  std::string message;
};

Outcome read(std::string_view text, const StructureOptions& options) {
  try {
    return {parse_atoms(text, format, name, options), {}};
  } catch (const Error& error) {
    return {{}, checked_message(error, name)};
  }
}

void expect_whole(const AtomFile& file, std::string_view text) {
  const std::size_t count = file.atoms.size();
  const auto lines = static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n')) + 1;
  expect(count > 0, "neither atoms nor an error");
  expect(file.lines.size() == count && file.labels.size() == count, "atoms, lines and labels");
  expect(file.structure.has_value(), "no report");
  const StructureReport& report = *file.structure;
  expect(report.atom_records + report.hetatm_records + report.waters == count, "counts of atoms");
  for (std::size_t i = 0; i < count; ++i) {
    const Atom& atom = file.atoms[i];
    for (std::size_t axis = 0; axis < 3; ++axis)
      expect(std::fabs(atom.center[axis]) <= max_length, "a coordinate out of range");
    expect(atom.radius >= 0 && atom.radius <= max_length, "a radius out of range");
    expect(file.lines[i] >= 1 && file.lines[i] <= lines, "a line that is not there");
  }
}

void check(std::string_view text) {
  StructureOptions options;
  options.unknown_radius = 1;
  options.with_waters = true;
  options.hydrogens = HydrogenChoice::keep;
  const Outcome all = read(text, options);
  if (all.message.empty()) expect_whole(all.file, text);
  // Other options use other paths through the reader. They select a part of the atoms.
  options = {};
  options.radii = "msms";
  options.unknown_radius = 1;
  const Outcome part = read(text, options);
  if (part.message.empty()) {
    expect_whole(part.file, text);
    expect(part.file.atoms.size() <= all.file.atoms.size(), "more atoms than all");
  }
  // Without a temporary string g++ 12 falsely warns of overlapping copies (-Wrestrict).
  options.assembly = std::string("1");
  read(text, options);
}

}  // namespace
}  // namespace eses::detail::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  eses::detail::fuzz::check(eses::detail::fuzz::as_text(data, size));
  return 0;
}
