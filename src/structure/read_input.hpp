#pragma once
/// Reading atoms from files of any format.

#include <filesystem>
#include <functional>
#include <string_view>

#include "eses/read_atoms.hpp"

namespace eses::detail {

/// read_atoms, which calls `after_part` now and then with what it has read so far.
AtomFile read_input(const std::filesystem::path& path, const ReadOptions& options,
                    const std::function<void(AtomFile& atoms)>& after_part);

/// Reads the atoms of a PDB or mmCIF text. Throws Error as read_atoms does.
AtomFile parse_structure_atoms(std::string_view text, std::string_view name,
                               const ReadOptions& options);

}  // namespace eses::detail
