#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eses/error.hpp"
#include "eses/radii.hpp"
#include "input/pdb_elements.hpp"
#include "input/radii_set.hpp"
#include "input/residue_atoms.hpp"
#include "input/residue_runs.hpp"

namespace eses {

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

}  // namespace eses
