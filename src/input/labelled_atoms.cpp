// The functions of eses/radii.hpp: radii, elements, water and polarity of labelled atoms.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "eses/error.hpp"
#include "eses/radii.hpp"
#include "eses/vec3.hpp"
#include "input/atom_names.hpp"
#include "input/pdb_elements.hpp"
#include "input/radii_set.hpp"
#include "input/residue_atoms.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses {
namespace detail {
namespace {

/// An element that programs take for another one, because they read only the first letter of a
/// name. The distance, in angstrom, is between the bond lengths of both.
struct MisreadElement {
  std::string_view symbol, taken_for;
  double min_distance;
  double max_distance = std::numeric_limits<double>::infinity();
};
// Longest bond of these metals, in angstrom. Without another atom within it, as in residues of
// which only some atoms are known, nothing contradicts the element.
constexpr double max_metal_bond = 2.7;
constexpr std::array<MisreadElement, 10> misread_elements{{{"CL", "C", 1.63},
                                                           {"BR", "B", 1.7},
                                                           {"SI", "S", 1.55},
                                                           {"SE", "S", 1.87},
                                                           {"FE", "F", 1.6},
                                                           {"CU", "C", 1.75, max_metal_bond},
                                                           {"CO", "C", 1.75, max_metal_bond},
                                                           {"NI", "N", 1.75, max_metal_bond},
                                                           {"PT", "P", 1.92, max_metal_bond},
                                                           {"PD", "P", 1.92, max_metal_bond}}};

/// The atoms of a residue, in a range of the atoms of a molecule.
struct ResidueRange {
  std::span<const Vec3> centers;
  std::span<const AtomLabel> labels;

  /// Returns the distance to the nearest other atom of known element.
  double distance_to_nearest(std::size_t atom) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (i != atom && !usual_spelling(labels[i].element).empty())
        least = std::min(least, norm(centers[i] - centers[atom]));
    return least;
  }
};

/// Returns the element of two letters that a name begins with and that has been taken for its first
/// letter; empty if there is none.
std::string_view misread_element(const ResidueRange& residue, std::size_t atom,
                                 std::string_view name, std::string_view element) {
  for (const auto& [symbol, taken_for, min_distance, max_distance] : misread_elements) {
    if (element != taken_for || !name.starts_with(symbol) ||
        (name.size() > symbol.size() && !is_digit(name[symbol.size()])))
      continue;
    const double distance = residue.distance_to_nearest(atom);
    if (distance > min_distance && distance <= max_distance) return symbol;
  }
  return {};
}

/// Returns the first letter of a name if its first two letters have been taken for a metal or a
/// noble gas, as sodium for the nitrogen NA of haem, although another atom is too close for it.
std::string_view misread_letter(const ResidueRange& residue, std::size_t atom,
                                std::string_view name, std::string_view element) {
  constexpr double min_distance = 1.58;  // angstrom; Cr-O and Mn-O have 1.6
  const bool is_misread =
      element.size() == 2 && name.starts_with(upper_case(std::string(element))) &&
      std::string_view("CNOPSH").find(name[0]) != std::string_view::npos &&
      !has_word("Cl Se Si", element) && residue.distance_to_nearest(atom) < min_distance;
  return is_misread ? name.substr(0, 1) : std::string_view();
}

/// Returns the element of an atom by its names and its residue, or the element that it has.
std::string corrected_element(const ResidueRange& residue, std::size_t atom) {
  const AtomLabel& label = residue.labels[atom];
  const std::string element = usual_spelling(label.element);
  const std::string name = upper_case(label.atom_name), of = upper_case(label.residue);
  NamedAtom named{name, of, is_named_polymer(of), residue.labels.size() == 1};
  if (named.is_alone && !named.is_polymer && is_ion(named))
    return usual_spelling(element_by_name(named));
  if (is_water_bead(of)) return "O";
  if (element.empty() || of.empty()) return element;
  if (named.is_polymer) {
    const std::string by_name = usual_spelling(element_by_name(named));
    if (by_name == "H" || by_name == "D") return element == "D" ? element : by_name;
    // CA and SC1 of unusual residues and of beads are no calcium and no scandium.
    const bool is_misread =
        element.size() == 2 && name.starts_with(upper_case(std::string(element)));
    const bool is_known =
        is_misread || may_have_atom(standard_residue(residue.labels), label.atom_name);
    return by_name.empty() || !is_known ? element : by_name;
  }
  constexpr std::size_t max_atoms = 1000;  // distances of all pairs of a crystal would take long
  if (residue.labels.size() > max_atoms) return element;
  for (const auto& find : {misread_element, misread_letter})
    if (const std::string_view found = find(residue, atom, name, element); !found.empty())
      return usual_spelling(found);
  return element;
}

bool is_hydrogen(const AtomLabel& label) { return label.element == "H" || label.element == "D"; }

/// Returns whether a residue is a bead of water, or has an atom that it cannot have by its name.
bool is_foreign(std::span<const AtomLabel> residue) {
  const std::string_view standard = standard_residue(residue);
  return std::any_of(residue.begin(), residue.end(), [&](const AtomLabel& atom) {
    return is_water_bead(atom.residue) ||
           (!is_hydrogen(atom) && !may_have_atom(standard, atom.atom_name));
  });
}

/// Returns the name and the element of an atom.
std::pair<std::string, std::string> names_of(const AtomLabel& atom) {
  const std::string element = usual_spelling(atom.element);
  return {atom.atom_name, element.empty() ? symbol_by_name(atom.atom_name, atom.residue) : element};
}

/// The atoms of a residue, for their polarity.
struct PolarityOfResidue {
  std::span<const Atom> atoms;
  std::span<const AtomLabel> labels;

  /// Returns whether an atom that is no hydrogen is polar.
  bool is_polar(std::size_t i) const {
    if (labels[i].atom_class != AtomClass::none) return labels[i].atom_class == AtomClass::polar;
    const std::string_view element = labels[i].element;
    const bool is_halogen = has_word("F Cl Br I", element);
    return !has_word("C B Si", element) && !(is_halogen && labels.size() > 1);
  }

  /// Returns whether the nearest atom to a hydrogen that is no hydrogen is polar.
  bool has_polar_parent(const Atom& hydrogen) const {
    double least = std::numeric_limits<double>::infinity();
    bool has_polar = false;
    for (std::size_t i = 0; i < atoms.size(); ++i) {
      const double distance = squared_norm(atoms[i].center - hydrogen.center);
      if (is_hydrogen(labels[i]) || distance >= least) continue;
      least = distance;
      has_polar = is_polar(i);
    }
    return has_polar;
  }
};

void add_example(Diagnostic& diagnostic, std::size_t atom) {
  const auto index = static_cast<AtomIndex>(atom);
  if (++diagnostic.count <= Diagnostic::max_examples) diagnostic.examples.push_back({index, index});
}

}  // namespace
}  // namespace detail

std::vector<AtomIndex> correct_elements(std::span<const Vec3> centers,
                                        std::span<AtomLabel> labels) {
  if (centers.size() != labels.size())
    throw Error(detail::formatted("{} centres, but {} labels", centers.size(), labels.size()));
  std::vector<AtomIndex> changed;
  std::vector<std::string> elements;  // of a residue
  detail::for_each_residue(labels, [&](std::size_t begin, std::size_t end) {
    const detail::ResidueRange residue{centers.subspan(begin, end - begin),
                                       labels.subspan(begin, end - begin)};
    elements.clear();
    for (std::size_t i = 0; i < end - begin; ++i)
      elements.push_back(detail::corrected_element(residue, i));
    for (std::size_t i = begin; i < end; ++i) {
      if (detail::usual_spelling(labels[i].element) == elements[i - begin]) continue;
      labels[i].element = std::move(elements[i - begin]);
      changed.push_back(static_cast<AtomIndex>(i));
    }
  });
  return changed;
}

std::vector<bool> find_waters(std::span<const AtomLabel> atoms) {
  std::vector<bool> found(atoms.size());
  detail::for_each_residue(atoms, [&](std::size_t begin, std::size_t end) {
    const std::span residue = atoms.subspan(begin, end - begin);
    if (detail::is_water_residue(residue.front().residue, residue, detail::names_of))
      std::fill(found.begin() + static_cast<std::ptrdiff_t>(begin),
                found.begin() + static_cast<std::ptrdiff_t>(end), true);
  });
  return found;
}

std::vector<Diagnostic> check_residues(std::span<const AtomLabel> atoms) {
  std::uint64_t polymers = 0;
  Diagnostic traces{DiagnosticKind::one_atom_residue, 0, {}},
      foreign{DiagnosticKind::foreign_residue, 0, {}};
  detail::for_each_residue(atoms, [&](std::size_t begin, std::size_t end) {
    const std::span residue = atoms.subspan(begin, end - begin);
    if (detail::is_named_polymer(residue.front().residue)) {
      ++polymers;
      if (detail::is_trace(residue, [](const AtomLabel& atom) { return atom.atom_name; }))
        detail::add_example(traces, begin);
    }
    if (detail::is_foreign(residue)) detail::add_example(foreign, begin);
  });
  std::vector<Diagnostic> found;
  if (2 * traces.count > polymers) found.push_back(std::move(traces));
  if (foreign.count > 0) found.push_back(std::move(foreign));
  return found;
}

NamedRadii find_radii(std::span<const AtomLabel> atoms, const std::string& set) {
  const detail::RadiiSet radii = detail::find_radii_set(set);
  if (radii.is_occupancy)
    throw Error("radii: 'occupancy' needs a PDB or mmCIF file, which has the radii");
  std::vector<AtomLabel> labels(atoms.begin(), atoms.end());
  detail::complete_elements(labels);
  NamedRadii found{.set = radii.name, .are_united = radii.is_united, .atoms = {}};
  found.atoms.reserve(labels.size());
  detail::for_each_residue(labels, [&](std::size_t begin, std::size_t end) {
    const std::string_view standard =
        detail::standard_residue(std::span(labels).subspan(begin, end - begin));
    for (std::size_t i = begin; i < end; ++i) {
      AtomLabel& label = labels[i];
      if (label.element == "D") label.element = "H";
      const detail::AtomIdentity identity{label.residue, label.atom_name, label.element,
                                          label.element == "H", standard};
      const auto radius = radii.find(identity);
      found.atoms.push_back(
          {.radius = radius ? radius->radius : std::numeric_limits<double>::quiet_NaN(),
           .element = label.element,
           .is_by_element = radius && radius->by_element,
           .is_element_by_name = atoms[i].element.empty() && !label.element.empty(),
           .atom_class = radii.class_of(identity)});
    }
  });
  return found;
}

std::vector<bool> find_polar_atoms(std::span<const Atom> atoms, std::span<const AtomLabel> labels) {
  std::vector<bool> are_polar(atoms.size());
  detail::for_each_residue(labels, [&](std::size_t first, std::size_t end) {
    const detail::PolarityOfResidue residue{atoms.subspan(first, end - first),
                                            labels.subspan(first, end - first)};
    for (std::size_t i = first; i < end; ++i)
      are_polar[i] = detail::is_hydrogen(labels[i]) && labels[i].atom_class == AtomClass::none
                         ? residue.has_polar_parent(atoms[i])
                         : residue.is_polar(i - first);
  });
  return are_polar;
}

}  // namespace eses
