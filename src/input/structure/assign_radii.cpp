#include "input/structure/assign_radii.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "eses/error.hpp"
#include "input/residue_atoms.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

/// Atoms with the same names and element, which have the same radius.
struct AtomKind {
  RadiusSource source;
  bool is_known, is_by_element;
  bool is_foreign;  ///< is no atom of its amino acid or nucleotide
  bool is_named;    ///< is an atom that the user's set of radii names
  std::uint64_t first_line;
  AtomClass atom_class;
  std::uint64_t guessed = 0;  ///< number of atoms whose element follows from their names
};

/// The kinds of atoms in the order of their first atoms.
class AtomKinds {
 public:
  AtomKinds(const ParsedStructure& parsed, const RadiiSet& radii, std::string_view file,
            double unknown_radius)
      : parsed_(parsed), radii_(radii), file_(file), unknown_radius_(unknown_radius) {}

  /// Counts an atom and returns its kind.
  const AtomKind& add(const StructureAtom& atom) {
    const double occupancy = radii_.is_occupancy ? occupancy_of(atom) : 0;
    const std::string &residue = atom.residue->name, &name = atom.atom->name;
    const std::string_view element = symbol_of(atom.atom->element);
    if (atom.residue != residue_) {
      residue_ = atom.residue;
      standard_ = standard_residue(*residue_);
    }
    key_.assign(standard_)
        .append(1, '\0')
        .append(residue)
        .append(1, '\0')
        .append(name)
        .append(1, '\0')
        .append(element);
    if (radii_.is_occupancy) key_.append(1, '\0').append(formatted("{}", occupancy));
    const auto [at, is_new] = indices_.try_emplace(key_, kinds_.size());
    if (is_new) {
      const AtomIdentity identity{residue, name, element, atom.atom->is_hydrogen(), standard_};
      const auto found = radii_.find(identity);
      const double radius = radii_.is_occupancy ? occupancy
                            : found             ? found->radius
                                                : unknown_radius_;
      const bool is_named = radii_.is_from_file && found && !found->by_element;
      const bool is_bead = is_water_bead(residue) && atom.atom->element == gemmi::El::O;
      const bool is_foreign =
          !is_named && !atom.atom->is_hydrogen() &&
          (is_bead || (is_polymer_residue(residue) && !may_have_atom(standard_, name)));
      kinds_.push_back({{residue, name, std::string(element), radius},
                        found.has_value(),
                        found && found->by_element,
                        is_foreign,
                        is_named,
                        parsed_.source_of(*atom.atom).line,
                        radii_.class_of(identity)});
    }
    AtomKind& kind = kinds_[at->second];
    ++kind.source.count;
    if (parsed_.source_of(*atom.atom).is_element_by_name) ++kind.guessed;
    return kind;
  }

  const std::vector<AtomKind>& all() const { return kinds_; }

 private:
  /// Returns the radius that an atom has in place of its occupancy. gemmi has rounded the number of
  /// the file to `float`. The shortest text of that is the number, if it has up to six digits.
  double occupancy_of(const StructureAtom& atom) const {
    double radius = 0;
    parse_number(formatted("{}", atom.atom->occ), radius);
    if (!(radius >= 0 && radius <= max_set_radius))
      fail_at_line(file_, parsed_.source_of(*atom.atom).line,
                   formatted("expected a radius from 0 to {:.0f} angstrom in place of the "
                             "occupancy, found {}",
                             max_set_radius, radius));
    return radius;
  }

  const ParsedStructure& parsed_;
  const RadiiSet& radii_;
  std::string_view file_;
  double unknown_radius_;
  const gemmi::Residue* residue_ = nullptr;  // of the last atom
  std::string_view standard_;                // the standard residue of `residue_`
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

/// Adds the sources of radii and elements to the report. Returns the line of the first atom without
/// a radius. Elements of polymers and water follow from their names without doubt.
std::uint64_t report_kinds(const std::vector<AtomKind>& kinds, StructureReport& report) {
  std::uint64_t unknown_line = 0;
  for (const AtomKind& kind : kinds) {
    const std::string& residue = kind.source.residue;
    if (kind.is_by_element) report.by_element.push_back(kind.source);
    if (kind.guessed > 0 && !is_polymer_residue(residue) &&
        !gemmi::find_tabulated_residue(residue).is_water()) {
      report.guessed_elements.push_back(kind.source);
      report.guessed_elements.back().count = kind.guessed;
    }
    if (kind.is_known) continue;
    if (report.unknown.empty()) unknown_line = kind.first_line;
    report.unknown.push_back(kind.source);
  }
  return unknown_line;
}

/// Throws Error if the numbers in place of the occupancies are occupancies.
void require_radii_in_occupancies(const std::vector<Atom>& atoms, std::string_view file) {
  if (std::none_of(atoms.begin(), atoms.end(), [](const Atom& atom) { return atom.radius > 1; }))
    throw Error(formatted(
        "{}: no atom has an occupancy above 1, so they are no radii; choose a set of radii", file));
}

AtomLabel label_of(const StructureAtom& atom, AtomClass atom_class) {
  const gemmi::Element element = atom.atom->element;
  return {*atom.chain,
          atom.residue->name,
          atom.residue->seqid.str(),
          atom.atom->name,
          element == gemmi::El::X ? "" : symbol_of(element),
          atom_class};
}

}  // namespace

void assign_radii(const std::vector<StructureAtom>& atoms, const ParsedStructure& parsed,
                  const RadiiSet& radii, const StructureText& text, AtomFile& result,
                  const NameStore& store) {
  constexpr std::size_t part_atoms = std::size_t{1} << 14;
  const std::optional<double> unknown_radius = text.options.structure.unknown_radius;
  result.atoms.reserve(atoms.size());
  result.lines.reserve(atoms.size());
  if (text.options.with_labels && !store.is_used()) result.labels.reserve(atoms.size());
  const auto end_part = [&] {
    text.check();
    if (store.is_used()) store.take(result);
  };
  AtomKinds kinds(parsed, radii, text.name, unknown_radius.value_or(0));
  Diagnostic foreign{DiagnosticKind::foreign_residue, 0, {}};
  const gemmi::Residue* last_foreign = nullptr;
  for (const StructureAtom& atom : atoms) {
    const AtomKind& kind = kinds.add(atom);
    const bool lacks_backbone = has_no_backbone(*atom.residue) && !kind.is_named;
    if ((kind.is_foreign || lacks_backbone) && atom.residue != last_foreign) {
      last_foreign = atom.residue;
      const auto index = static_cast<AtomIndex>(result.atoms.size());
      if (++foreign.count <= Diagnostic::max_examples) foreign.examples.push_back({index, index});
    }
    result.atoms.push_back({atom.center, kind.source.radius});
    result.lines.push_back(parsed.source_of(*atom.atom).line);
    if (text.options.with_labels) result.labels.push_back(label_of(atom, kind.atom_class));
    if (result.atoms.size() % part_atoms == 0) end_part();
  }
  if (radii.is_occupancy) require_radii_in_occupancies(result.atoms, text.name);
  if (foreign.count > 0) result.diagnostics.push_back(std::move(foreign));
  result.structure->radii = radii.name;
  const std::uint64_t unknown_line = report_kinds(kinds.all(), *result.structure);
  const std::vector<RadiusSource>& unknown = result.structure->unknown;
  if (!unknown.empty() && !unknown_radius)
    fail_for_unknown(unknown, unknown_line, radii.name, text.name);
  end_part();
}

}  // namespace eses::detail
