#include "cli/diagnostics.hpp"

#include <fmt/ranges.h>

#include <array>
#include <cstddef>
#include <map>

#include "input/text_source.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

struct Wording {
  std::string_view name;
  std::string_view one, several;  // text after the count
  std::string_view relation;      // text between the lines of an atom and of the other atom
};

/// By DiagnosticKind.
constexpr std::array<Wording, diagnostic_kinds> wordings{{
    {"duplicate", "atom has the centre and radius of an earlier one",
     "atoms have the centre and radius of an earlier one", "as"},
    {"close", "atom is within 0.5 angstrom of an earlier one",
     "atoms are within 0.5 angstrom of an earlier one", "near"},
    {"nested", "atom lies wholly inside another one", "atoms lie wholly inside another one", "in"},
    {"large_radius", "atom has a radius above 4 angstrom", "atoms have a radius above 4 angstrom",
     ""},
    {"small_radii", "atom, with a radius below 0.4 angstrom; are lengths in nanometres?",
     "atoms, all with a radius below 0.4 angstrom; are lengths in nanometres?", ""},
    {"one_atom_residue",
     "residue has a single atom; area and volume are not those of the whole molecule",
     "residues have a single atom, as in models of C-alpha atoms; area and volume are not those of "
     "the whole molecule",
     ""},
    {"foreign_residue",
     "residue is no amino acid or nucleotide of its name: it has other atoms or no backbone, as in "
     "coarse-grained models; its elements and radii are guesses",
     "residues are no amino acids or nucleotides of their names: they have other atoms or no "
     "backbone, as in coarse-grained models; their elements and radii are guesses",
     ""},
    {"nanometre_coordinates", "atom is within 0.3 angstrom of its nearest neighbour",
     "atoms are within 0.3 angstrom of their nearest neighbours, but their radii are in angstrom; "
     "coordinates look like nanometres; multiply them by 10",
     ""},
    {"unread_record",
     "line has coordinates, but its record name is neither ATOM nor HETATM; it is not read",
     "lines have coordinates, but their record names are neither ATOM nor HETATM; they are not "
     "read",
     ""},
    {"zero_radius", "of radius 0", "of radius 0", ""},
    {"nested_usual", "of at most 1.4 angstrom inside another atom",
     "of at most 1.4 angstrom inside another atom", "in"},
    {"water", "of water, which pdb2pqr leaves out with --drop-water",
     "of water, which pdb2pqr leaves out with --drop-water", ""},
}};

/// Returns the number of a line, with the label of its atom if there is one.
std::string line_text(std::uint64_t line, const std::optional<std::string>& label) {
  return label ? formatted("{}, {}", line, *label) : formatted("{}", line);
}

std::string lines_text(const DiagnosticText& text, std::string_view relation) {
  std::vector<std::string> parts;
  bool has_labels = false;
  for (const DiagnosticText::Example& example : text.examples) {
    has_labels = has_labels || example.label;
    std::string& part = parts.emplace_back(line_text(example.line, example.label));
    if (example.other_line)
      part += formatted(" ({} {})", relation, line_text(*example.other_line, example.other_label));
  }
  const std::uint64_t more = text.count - text.examples.size();
  return formatted("{} {}{}", text.count == 1 ? "line" : "lines",
                   fmt::join(parts, has_labels ? "; " : ", "),
                   more > 0 ? formatted(" and {} more", more) : "");
}

/// Returns a label such as `A/LYS 33/CE`, if it is known.
std::optional<std::string> label_text(const std::map<FileIndex, AtomLabel>& labels,
                                      FileIndex atom) {
  const auto found = labels.find(atom);
  if (found == labels.end()) return std::nullopt;
  const auto& [chain, residue, number, name, element] = found->second;
  return formatted("{}/{} {}/{}", chain, residue, number, name);
}

}  // namespace

std::vector<DiagnosticText> describe(const FileDiagnostics& diagnostics,
                                     const std::filesystem::path& input) {
  const auto& [all, lines, labels] = diagnostics;
  std::vector<DiagnosticText> texts;
  for (const auto& [kind, count, examples] : all) {
    const Wording& wording = wordings[static_cast<std::size_t>(kind)];
    DiagnosticText& text = texts.emplace_back();
    text.name = wording.name;
    text.is_usual = is_usual(kind);
    text.count = count;
    text.short_text = count == 1 ? wording.one : wording.several;
    for (const auto& [atom, other, of_record] : examples) {
      if (of_record > 0) {
        text.examples.push_back({.line = of_record});
        continue;
      }
      auto& example = text.examples.emplace_back(DiagnosticText::Example{
          atom, lines.at(FileIndex{atom}), label_text(labels, FileIndex{atom})});
      if (other == atom) continue;
      example.other_atom = other;
      example.other_line = lines.at(FileIndex{other});
      example.other_label = label_text(labels, FileIndex{other});
    }
    text.message = formatted("{}: {} {}: {}", input_name(input), text.count, text.short_text,
                             lines_text(text, wording.relation));
  }
  return texts;
}

std::vector<DiagnosticText> describe(const AtomFile& atoms, const Surface& surface,
                                     const std::filesystem::path& input) {
  FileDiagnostics all;
  all.add(atoms.diagnostics, atoms.lines);
  all.add(surface.diagnostics(), atoms.lines);
  if (!surface.labels().empty())
    for (const auto& [atom, line] : all.lines) all.labels[atom] = surface.labels()[as_number(atom)];
  return describe(all, input);
}

}  // namespace eses::detail::cli
