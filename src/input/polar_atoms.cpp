#include <cstddef>
#include <limits>
#include <string_view>

#include "eses/radii.hpp"
#include "input/residue_runs.hpp"
#include "input/text_fields.hpp"

namespace eses {
namespace {

bool is_hydrogen(const AtomLabel& label) { return label.element == "H" || label.element == "D"; }

/// The atoms of a residue.
struct Residue {
  std::span<const Atom> atoms;
  std::span<const AtomLabel> labels;

  /// Returns whether an atom that is no hydrogen is polar.
  bool is_polar(std::size_t i) const {
    if (labels[i].atom_class != AtomClass::none) return labels[i].atom_class == AtomClass::polar;
    const std::string_view element = labels[i].element;
    const bool is_halogen = detail::has_word("F Cl Br I", element);
    return !detail::has_word("C B Si", element) && !(is_halogen && labels.size() > 1);
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

}  // namespace

std::vector<bool> find_polar_atoms(std::span<const Atom> atoms, std::span<const AtomLabel> labels) {
  std::vector<bool> are_polar(atoms.size());
  detail::for_each_residue(labels, [&](std::size_t first, std::size_t end) {
    const Residue residue{atoms.subspan(first, end - first), labels.subspan(first, end - first)};
    for (std::size_t i = first; i < end; ++i)
      are_polar[i] = is_hydrogen(labels[i]) && labels[i].atom_class == AtomClass::none
                         ? residue.has_polar_parent(atoms[i])
                         : residue.is_polar(i - first);
  });
  return are_polar;
}

}  // namespace eses
