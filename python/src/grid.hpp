#pragma once
/// Bindings for grids.

#include <pybind11/pybind11.h>

namespace eses::python {

void bind_grid(pybind11::module_& module);

}  // namespace eses::python
