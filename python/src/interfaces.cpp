#include "interfaces.hpp"

#include <pybind11/stl.h>

#include <cstddef>
#include <cstdint>
#include <eses/eses.hpp>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "chosen_surface.hpp"
#include "interrupts.hpp"
#include "threads.hpp"

namespace eses::python {
namespace {

// Returns a tuple for each interface: the numbers of its parts, and the indices, lost SAS areas and
// lost SES areas of its atoms. The part of an atom that is left out is negative.
py::list measure_parts(const ChosenSurface& surface, const std::vector<std::int64_t>& parts,
                       ThreadCount threads) {
  const std::vector<std::uint32_t> numbers(parts.begin(), parts.end());
  std::vector<Interface> found;
  {
    Interrupts interrupts;
    const py::gil_scoped_release release;
    found = measure_interfaces(surface, numbers, {.threads = usable_threads(threads), .check = [&] {
                                                    interrupts.check();
                                                  }});
  }
  py::list interfaces;
  for (const Interface& interface : found) {
    const auto count = static_cast<py::ssize_t>(interface.atoms.size());
    auto atoms = make_array<std::int64_t>(count);
    auto sas_lost = make_array<double>(count), ses_lost = make_array<double>(count);
    for (py::ssize_t i = 0; i < count; ++i) {
      const BuriedAtom& buried = interface.atoms[static_cast<std::size_t>(i)];
      atoms.mutable_at(i) = buried.atom;
      sas_lost.mutable_at(i) = buried.sas;
      ses_lost.mutable_at(i) = buried.ses;
    }
    interfaces.append(py::make_tuple(interface.first, interface.second, atoms, sas_lost, ses_lost));
  }
  return interfaces;
}

// Returns whether each atom is polar. Atoms of a residue follow each other and have its number.
std::vector<bool> polar_atoms(const py::object& centers, const std::vector<std::string>& elements,
                              const std::vector<std::int64_t>& residues,
                              const std::vector<int>& classes) {
  const std::vector<double> radii(elements.size());
  const std::vector<Atom> atoms = make_atoms(centers, py::cast(radii));
  if (residues.size() != atoms.size() || classes.size() != atoms.size())
    throw py::value_error("centers, elements, residues and classes differ in length");
  std::vector<AtomLabel> labels(atoms.size());
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    labels[i].element = elements[i];
    labels[i].residue_number = std::to_string(residues[i]);
    labels[i].atom_class = static_cast<AtomClass>(classes[i]);
  }
  return find_polar_atoms(atoms, labels);
}

}  // namespace

void bind_interfaces(py::module_& module) {
  module.def("_measure_interfaces", &measure_parts);
  module.def("_find_polar", &polar_atoms);
}

}  // namespace eses::python
