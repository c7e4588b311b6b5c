#pragma once
/// Reading of atoms from files of any format.

#include <filesystem>
#include <functional>
#include <string_view>

#include "eses/read_atoms.hpp"

namespace eses::detail {

/// Implements read_atoms. Calls `after_part` after each part with the atoms read so far. For
/// these, the elements in a PQR file are not completed yet; see complete_elements.
AtomFile read_input(const std::filesystem::path& path, const ReadOptions& options,
                    const std::function<void(AtomFile& atoms)>& after_part);

/// Reads the atoms of a PDB or mmCIF text. Throws Error as read_atoms does.
AtomFile parse_structure_atoms(std::string_view text, std::string_view name,
                               const ReadOptions& options);

}  // namespace eses::detail
