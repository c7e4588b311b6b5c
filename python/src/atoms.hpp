#pragma once
/// Bindings for atoms read from files.

#include <pybind11/pybind11.h>

#include <cstddef>
#include <eses/eses.hpp>
#include <string>

namespace eses::python {

/// Returns an array of `count` strings: one member of the labels of a file, or empty strings if
/// there are no labels.
pybind11::object texts_of(const AtomFile& file, std::size_t count, std::string AtomLabel::*member);

void bind_atoms(pybind11::module_& module);

}  // namespace eses::python
