#pragma once
/// Reading of atoms from files of any format.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/read_atoms.hpp"
#include "input/atom_names.hpp"

namespace eses::detail {

struct RadiiSet;

/// Implements read_atoms. The labels go to `store`, if it is used. `radii` is the set that the
/// options name, if it has been found before.
AtomFile read_input(const std::filesystem::path& path, ReadOptions options,
                    const NameStore& store = {}, const RadiiSet* radii = nullptr);

/// Returns the numbers of the models of a PDB or mmCIF file, in its order. Throws Error if it
/// cannot be read, or if the name of a model is no number.
std::vector<int> read_model_numbers(const std::filesystem::path& path, ReadOptions options);

/// The spheres of an input file of MSMS.
struct SphereFile {
  std::vector<Atom> spheres;         ///< in the order of the file
  std::vector<std::uint64_t> lines;  ///< of the file, from 1, by sphere
  std::vector<std::string> names;    ///< by sphere; empty if the file has no names
};

/// Reads spheres with names: `x y z r 1 NAME` (xyzrn, from pdb_to_xyzrn), `x y z r NAME`, or
/// `x y z r` (xyzr). Blanks or tabs separate the columns. The suffix of the file does not matter.
/// Throws Error as read_atoms does, and if some of the spheres lack a name.
SphereFile read_spheres(const std::filesystem::path& path);

}  // namespace eses::detail
