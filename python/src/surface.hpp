#pragma once
/// Bindings for surfaces and their computations.

#include <pybind11/pybind11.h>

#include <optional>

namespace eses::python {

/// Returns the value of SurfaceOptions::max_filled_void for the argument `fill_cavities`: whether
/// all cavities are filled, or the maximum volume of the voids that are, in cubic angstrom. Raises
/// TypeError if it is neither a boolean nor a real number.
std::optional<double> max_filled_void(const pybind11::object& fill_cavities);

void bind_surface(pybind11::module_& module);

}  // namespace eses::python
