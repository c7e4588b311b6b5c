#pragma once
/// Bindings for surfaces and their computations.

#include <pybind11/pybind11.h>

namespace eses::python {

void bind_surface(pybind11::module_& module);

}  // namespace eses::python
