#include "input/structure/assign_radii.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

#include "eses/error.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

/// Atoms with the same names and element, which have the same radius.
struct AtomKind {
  RadiusSource source;
  bool is_known, is_by_element;
  std::uint64_t first_line;
};

/// The kinds of atoms in the order of their first atoms.
class AtomKinds {
 public:
  AtomKinds(const RadiiSet& radii, double unknown_radius)
      : radii_(radii), unknown_radius_(unknown_radius) {}

  /// Counts an atom and returns its radius.
  double add(const StructureAtom& atom) {
    const std::string &residue = atom.residue->name, &name = atom.atom->name;
    const std::string_view element = symbol_of(atom.atom->element);
    key_.assign(residue).append(1, '\0').append(name).append(1, '\0').append(element);
    const auto [at, is_new] = indices_.emplace(key_, kinds_.size());
    if (is_new) {
      const auto found = radii_.find({residue, name, element, atom.atom->is_hydrogen()});
      const double radius = found ? found->radius : unknown_radius_;
      kinds_.push_back({{residue, name, std::string(element), radius},
                        found.has_value(),
                        found && found->by_element,
                        atom.line()});
    }
    RadiusSource& source = kinds_[at->second].source;
    ++source.count;
    return source.radius;
  }

  const std::vector<AtomKind>& all() const { return kinds_; }

 private:
  const RadiiSet& radii_;
  double unknown_radius_;
  std::string key_;
  std::unordered_map<std::string, std::size_t> indices_;
  std::vector<AtomKind> kinds_;
};

[[noreturn]] void fail_for_unknown(const std::vector<RadiusSource>& unknown, std::uint64_t line,
                                   std::string_view radii, std::string_view file) {
  constexpr std::size_t max_names = 10;
  std::vector<std::string> names;
  std::uint64_t atoms = 0;
  for (const RadiusSource& source : unknown) {
    atoms += source.count;
    if (names.size() < max_names)
      names.push_back(printable(formatted("{} {}", source.residue, source.atom_name)));
  }
  const std::size_t others = unknown.size() - names.size();
  fail_at_line(
      file, line,
      formatted("{} without a radius in the set {}: {}{}; use --unknown-radius, or a file "
                "with their radii for --radii",
                atoms == 1 ? "1 atom is" : formatted("{} atoms are", atoms), printable(radii),
                fmt::join(names, ", "), others > 0 ? formatted(" and {} more names", others) : ""));
}

AtomLabel label_of(const StructureAtom& atom) {
  const gemmi::Element element = atom.atom->element;
  return {*atom.chain, atom.residue->name, atom.residue->seqid.str(), atom.atom->name,
          element == gemmi::El::X ? "" : symbol_of(element)};
}

}  // namespace

void assign_radii(const std::vector<StructureAtom>& atoms, const RadiiSet& radii,
                  const StructureText& text, AtomFile& result,
                  const std::function<void(AtomFile& atoms)>& after_part) {
  constexpr std::size_t part_atoms = std::size_t{1} << 14;
  const std::optional<double> unknown_radius = text.options.structure.unknown_radius;
  result.atoms.reserve(atoms.size());
  result.lines.reserve(atoms.size());
  if (text.options.with_labels && !after_part) result.labels.reserve(atoms.size());
  const auto end_part = [&] {
    text.check();
    if (after_part) after_part(result);
  };
  AtomKinds kinds(radii, unknown_radius.value_or(0));
  for (const StructureAtom& atom : atoms) {
    result.atoms.push_back({atom.center, kinds.add(atom)});
    result.lines.push_back(atom.line());
    if (text.options.with_labels) result.labels.push_back(label_of(atom));
    if (result.atoms.size() % part_atoms == 0) end_part();
  }
  StructureReport& report = *result.structure;
  report.radii = radii.name;
  std::uint64_t unknown_line = 0;
  for (const AtomKind& kind : kinds.all()) {
    if (kind.is_by_element) report.by_element.push_back(kind.source);
    if (kind.is_known) continue;
    if (report.unknown.empty()) unknown_line = kind.first_line;
    report.unknown.push_back(kind.source);
  }
  if (!report.unknown.empty() && !unknown_radius)
    fail_for_unknown(report.unknown, unknown_line, radii.name, text.name);
  end_part();
}

}  // namespace eses::detail
