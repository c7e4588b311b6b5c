#pragma once
/// Bindings for surfaces and their computations.

#include <pybind11/pybind11.h>

#include <optional>
#include <variant>

namespace eses::python {

/// The argument `fill_cavities`: whether all cavities are filled, or the maximum volume of the
/// voids that are, in cubic angstrom.
using FillChoice = std::variant<double, bool>;

/// Returns the value of SurfaceOptions::max_filled_void.
std::optional<double> max_filled_void(const FillChoice& fill_cavities);

void bind_surface(pybind11::module_& module);

}  // namespace eses::python
