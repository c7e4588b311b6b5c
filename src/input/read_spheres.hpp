#pragma once
/// Reading of the input files of MSMS.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "eses/atoms.hpp"

namespace eses::detail {

/// The spheres of a file.
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
