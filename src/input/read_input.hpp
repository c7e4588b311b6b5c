#pragma once
/// Reading of atoms from files of any format.

#include <filesystem>
#include <functional>
#include <vector>

#include "eses/read_atoms.hpp"

namespace eses::detail {

struct RadiiSet;

/// Implements read_atoms. Calls `after_part` after each part with the atoms read so far. For
/// these, the elements in a PQR file are not completed yet; see complete_elements. `radii` is the
/// set that the options name, if it has been found before.
AtomFile read_input(const std::filesystem::path& path, ReadOptions options,
                    const std::function<void(AtomFile& atoms)>& after_part,
                    const RadiiSet* radii = nullptr);

/// Returns the numbers of the models of a PDB or mmCIF file, in its order. Throws Error if it
/// cannot be read, or if the name of a model is no number.
std::vector<int> read_model_numbers(const std::filesystem::path& path, ReadOptions options);

}  // namespace eses::detail
