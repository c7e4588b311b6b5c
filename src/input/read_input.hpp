#pragma once
/// Reading of atoms from files of any format.

#include <filesystem>
#include <functional>

#include "eses/read_atoms.hpp"

namespace eses::detail {

/// Implements read_atoms. Calls `after_part` after each part with the atoms read so far. For
/// these, the elements in a PQR file are not completed yet; see complete_elements.
AtomFile read_input(const std::filesystem::path& path, ReadOptions options,
                    const std::function<void(AtomFile& atoms)>& after_part);

}  // namespace eses::detail
