#pragma once
/// Python warnings about input that is valid but suspicious.

#include <pybind11/pybind11.h>

#include <cstdint>
#include <eses/eses.hpp>
#include <span>
#include <string>

namespace eses::python {

/// Issues a UserWarning at the line that has called this package. Raises it if the user has made
/// warnings errors.
void warn(const pybind11::str& text);

/// Warns of each diagnostic of the atoms of a surface that correct files do not have. `start`
/// begins the texts.
void warn_about(std::span<const Diagnostic> diagnostics, const std::string& start = "");

/// Warns of each diagnostic of the atoms of a file that correct files do not have, with its lines.
void warn_about(const AtomFile& file, const pybind11::str& name);

/// Warns of the atoms of find_stray_atoms by their indices in an object, of which the surface has
/// the atoms `kept`.
void warn_about_stray_atoms(const Surface& surface, std::span<const std::int64_t> kept);

/// Warns of atoms that make a grid large and empty. Raises ValueError if the program would refuse
/// the grid and `are_allowed` is false.
void check_far_atoms(const Surface& surface, const GridOptions& grid, bool are_allowed);

}  // namespace eses::python
