#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "eses/error.hpp"
#include "eses/radii.hpp"
#include "input/pdb_elements.hpp"
#include "input/radii_set.hpp"

namespace eses {

NamedRadii find_radii(std::span<const AtomLabel> atoms, const std::string& set) {
  const detail::RadiiSet radii = detail::find_radii_set(set);
  if (radii.is_occupancy)
    throw Error("radii: 'occupancy' needs a PDB or mmCIF file, which has the radii");
  std::vector<AtomLabel> labels(atoms.begin(), atoms.end());
  detail::complete_elements(labels);
  NamedRadii found{.set = radii.name, .are_united = radii.is_united, .atoms = {}};
  found.atoms.reserve(labels.size());
  for (std::size_t i = 0; i < labels.size(); ++i) {
    AtomLabel& label = labels[i];
    if (label.element == "D") label.element = "H";
    const auto radius =
        radii.find({label.residue, label.atom_name, label.element, label.element == "H"});
    found.atoms.push_back(
        {.radius = radius ? radius->radius : std::numeric_limits<double>::quiet_NaN(),
         .element = label.element,
         .is_by_element = radius && radius->by_element,
         .is_element_by_name = atoms[i].element.empty() && !label.element.empty()});
  }
  return found;
}

}  // namespace eses
