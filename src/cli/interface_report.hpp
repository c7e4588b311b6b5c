#pragma once
/// The texts of `eses-blocks interface`.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/diagnostics.hpp"
#include "cli/interface_options.hpp"
#include "eses/atoms.hpp"
#include "eses/interface.hpp"
#include "eses/read_atoms.hpp"

namespace eses::detail::cli {

/// An interface with the names of its sides.
struct NamedInterface {
  std::string first, second;
  Interface areas;
  std::vector<std::uint32_t> parts;  ///< part of each atom of the interface, as in `areas`
};

/// The interfaces of a file.
struct InterfaceFile {
  std::filesystem::path path;
  AtomFile file;  ///< with labels
  std::vector<DiagnosticText> diagnostics;
  std::vector<bool> are_polar;             ///< by atom
  std::vector<NamedInterface> interfaces;  ///< without those below InterfaceOptions::min_area
};

/// Returns the heading of a table; empty without one.
std::string interface_heading(const InterfaceOptions& options);

/// Returns what the command prints about a file: the report, rows of a table as CSV, or JSON.
std::string interface_text(const InterfaceOptions& options, const InterfaceFile& file);

}  // namespace eses::detail::cli
