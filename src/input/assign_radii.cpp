#include "input/assign_radii.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "eses/error.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

/// Atoms with the same names and element, which have the same radius.
struct AtomKind {
  std::optional<FoundRadius> found;
  RadiusSource source;
  std::uint64_t first_line = 0;
};

/// Cache of radii, with one entry for each combination of residue name, atom name and element.
class AtomKinds {
 public:
  AtomKinds(const SelectedStructure& structure, const RadiiSet& radii)
      : structure_(structure), radii_(radii) {}

  const std::optional<FoundRadius>& find(const StructureAtom& atom) {
    const std::string& residue = structure_.residues[atom.residue].name;
    const std::string& name = structure_.atom_names[atom.name];
    key_.assign(residue).append(1, '\0').append(name).append(1, static_cast<char>(atom.element));
    const auto [at, is_new] = indices_.emplace(key_, kinds_.size());
    if (is_new) {
      const std::string_view element = element_symbol(atom.element);
      kinds_.push_back({radii_.find({residue, name, element, atom.is_hydrogen}),
                        {residue, name, std::string(element)},
                        atom.line});
    }
    AtomKind& kind = kinds_[at->second];
    ++kind.source.count;
    return kind.found;
  }

  /// Returns the kinds of atoms for which `is_taken` is true, with their radii.
  std::vector<RadiusSource> sources(double unknown_radius, const auto& is_taken) const {
    std::vector<RadiusSource> taken;
    for (const AtomKind& kind : kinds_)
      if (is_taken(kind)) {
        taken.push_back(kind.source);
        taken.back().radius = kind.found ? kind.found->radius : unknown_radius;
      }
    return taken;
  }

  const std::vector<AtomKind>& all() const { return kinds_; }

 private:
  const SelectedStructure& structure_;
  const RadiiSet& radii_;
  std::string key_;
  std::unordered_map<std::string, std::size_t> indices_;
  std::vector<AtomKind> kinds_;
};

bool is_unknown(const AtomKind& kind) { return !kind.found; }
bool is_by_element(const AtomKind& kind) { return kind.found && kind.found->by_element; }

[[noreturn]] void fail_for_unknown(const AtomKinds& kinds, std::string_view radii,
                                   std::string_view file) {
  constexpr std::size_t max_names = 10;
  std::vector<std::string> names;
  std::uint64_t atoms = 0, line = 0;
  std::size_t others = 0;
  for (const AtomKind& kind : kinds.all()) {
    if (!is_unknown(kind)) continue;
    if (atoms == 0) line = kind.first_line;
    atoms += kind.source.count;
    if (names.size() < max_names)
      names.push_back(printable(formatted("{} {}", kind.source.residue, kind.source.atom_name)));
    else
      ++others;
  }
  throw Error(formatted(
      "{}:{}: {} without a radius in the set {}: {}{}; use --unknown-radius, or a file with their "
      "radii for --radii",
      file, line, atoms == 1 ? "1 atom is" : formatted("{} atoms are", atoms), printable(radii),
      fmt::join(names, ", "), others > 0 ? formatted(" and {} more names", others) : ""));
}

AtomLabel label_of(const SelectedStructure& structure, const StructureAtom& atom) {
  const StructureResidue& residue = structure.residues[atom.residue];
  const std::string_view element = atom.element == 0 ? "" : element_symbol(atom.element);
  return {residue.chain, residue.name, residue.number, structure.atom_names[atom.name],
          std::string(element)};
}

}  // namespace

AtomFile assign_radii(SelectedStructure structure, const RadiiSet& radii,
                      std::optional<double> unknown_radius, bool with_labels, std::string_view file,
                      const std::function<void(AtomFile& atoms)>& after_part) {
  constexpr std::size_t part_atoms = std::size_t{1} << 14;
  AtomFile result;
  result.atoms.reserve(structure.atoms.size());
  result.lines.reserve(structure.atoms.size());
  AtomKinds kinds(structure, radii);
  for (const StructureAtom& atom : structure.atoms) {
    const std::optional<FoundRadius>& found = kinds.find(atom);
    result.atoms.push_back({atom.center, found ? found->radius : unknown_radius.value_or(0)});
    result.lines.push_back(atom.line);
    if (with_labels) result.labels.push_back(label_of(structure, atom));
    if (after_part && result.atoms.size() % part_atoms == 0) after_part(result);
  }
  StructureReport& report = structure.report;
  report.radii = radii.name;
  report.by_element = kinds.sources(0, is_by_element);
  report.unknown = kinds.sources(unknown_radius.value_or(0), is_unknown);
  if (!report.unknown.empty() && !unknown_radius) fail_for_unknown(kinds, radii.name, file);
  result.structure = std::move(structure.report);
  if (after_part) after_part(result);
  return result;
}

}  // namespace eses::detail
