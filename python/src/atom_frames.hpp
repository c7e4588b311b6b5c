#pragma once
/// Tables of atoms as pandas frames. All functions raise ImportError if pandas is missing.

#include <pybind11/pybind11.h>

#include <eses/eses.hpp>
#include <memory>

#include "computed_result.hpp"

namespace eses::python {

/// Adds `to_dataframe` to the class of atoms.
void bind_atoms_frame(pybind11::class_<AtomFile, std::shared_ptr<AtomFile>>& atoms);

/// Adds `atom_table` to the class of results.
void bind_atom_table(pybind11::module_& module,
                     pybind11::class_<ComputedResult, std::shared_ptr<ComputedResult>>& result);

}  // namespace eses::python
