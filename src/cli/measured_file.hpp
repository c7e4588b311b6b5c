#pragma once
/// The measures of the atoms of a file, and of the parts of a complex.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/diagnostics.hpp"
#include "cli/measure_options.hpp"
#include "eses/measure.hpp"
#include "eses/pockets.hpp"
#include "eses/read_atoms.hpp"
#include "eses/surface.hpp"
#include "output/measure_tables.hpp"

namespace eses::detail::cli {

/// A part of a complex without the other parts.
struct MeasuredPart {
  std::string name;         ///< its chains, such as A,B
  std::uint64_t atoms = 0;  ///< number of atoms
  Measures measures;        ///< without areas by atom
};

struct MeasuredFile {
  std::filesystem::path path;
  Surface surface;                ///< of all parts together, or of all atoms
  std::uint64_t other_atoms = 0;  ///< number of atoms of the file that belong to no part
  Measures measures = {};
  Pockets pockets = {};                  ///< empty unless they were chosen
  std::vector<MeasuredPart> parts = {};  ///< empty if no parts were chosen
  std::vector<DiagnosticText> diagnostics = {};
  std::optional<StructureReport> structure = {};  ///< only for PDB and mmCIF files

  // For tables.
  std::optional<AreaReference> reference = {};
  std::vector<std::uint64_t> file_indices = {};  ///< empty if all atoms are in parts
  eses::AtomAreas areas_alone = {};              ///< areas of each atom in its part alone
  std::vector<std::uint32_t> part_of_atom = {};
  std::vector<std::string> part_names = {};

  /// Sum of an area of the parts minus the area of the complex, in square angstrom.
  double buried(double Measures::*area) const;

  MeasuredAtoms table() const;
};

/// Reads and measures a file. Throws Error if it cannot be read, or if it lacks a chain of a part.
MeasuredFile measure_file(const MeasureCommandOptions& options, const std::filesystem::path& path,
                          int threads, const CheckCallback& check);

}  // namespace eses::detail::cli
