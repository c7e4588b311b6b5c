#pragma once
/// Bindings for the interfaces between the parts of a complex.

#include <pybind11/pybind11.h>

namespace eses::python {

void bind_interfaces(pybind11::module_& module);

}  // namespace eses::python
