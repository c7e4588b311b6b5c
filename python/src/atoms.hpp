#pragma once
/// Bindings for atoms read from files.

#include <pybind11/pybind11.h>

namespace eses::python {

void bind_atoms(pybind11::module_& module);

}  // namespace eses::python
