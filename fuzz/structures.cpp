/// Fuzzes the reader of PDB and mmCIF files, for the format that the build chooses. For any text
/// the reader returns atoms with position, radius, line and label, or a well-formed error message.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "expect.hpp"
#include "parsed_atoms.hpp"

namespace eses::detail::fuzz {
namespace {

constexpr AtomFormat format = AtomFormat::ESES_FUZZ_FORMAT;
void expect_whole(const AtomFile& file, std::string_view text) {
  expect_valid_atoms(file);
  const std::size_t count = file.atoms.size();
  const auto lines = static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n')) + 1;
  expect(file.lines.size() == count && file.labels.size() == count, "atoms, lines and labels");
  expect(file.structure.has_value(), "no report");
  const StructureReport& report = *file.structure;
  expect(report.atom_records + report.hetatm_records + report.waters == count, "counts of atoms");
  for (const std::uint64_t line : file.lines)
    expect(line >= 1 && line <= lines, "a line that is not there");
}

/// Returns the number of atoms of the model that was read. It does not depend on the selection.
std::uint64_t atoms_of_model(const AtomFile& file) {
  const StructureReport& report = *file.structure;
  return file.atoms.size() + report.dropped_chains + report.dropped_selection +
         report.dropped_waters + report.dropped_hetatm + report.dropped_hydrogens +
         report.dropped_altlocs;
}

void check(std::string_view text) {
  StructureOptions options;
  options.unknown_radius = 1;
  options.with_waters = true;
  options.hydrogens = HydrogenChoice::keep;
  const ParsedAtoms all = parse(text, format, options);
  if (all.message.empty()) expect_whole(all.file, text);
  // Other options use other paths through the reader.
  options = {};
  options.radii = "msms";
  options.unknown_radius = 1;
  const ParsedAtoms part = parse(text, format, options);
  if (part.message.empty()) {
    expect_whole(part.file, text);
    // All atoms may be an error because of one that is not selected here.
    if (all.message.empty())
      expect(atoms_of_model(part.file) == atoms_of_model(all.file), "atoms of the model");
  }
  // Without a temporary string g++ 12 falsely warns of overlapping copies (-Wrestrict).
  options.assembly = std::string("1");
  parse(text, format, options);
}

}  // namespace
}  // namespace eses::detail::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  eses::detail::fuzz::check(eses::detail::fuzz::as_text(data, size));
  return 0;
}
