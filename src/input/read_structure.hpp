#pragma once
/// Reading of atoms from PDB and mmCIF texts.

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "eses/read_atoms.hpp"
#include "input/reading_limit.hpp"

namespace eses::detail {

struct RadiiSet;

/// The text of a PDB or mmCIF file, and how it is read.
struct StructureText {
  std::string_view text;
  std::string_view name;  ///< name of the file, for messages
  AtomFormat format = AtomFormat::pdb;
  /// Whether the name has the suffix of an assembly file of the PDB, such as .pdb1.
  bool is_assembly_file = false;
  bool is_chosen = false;  ///< whether the user has chosen the format
  const ReadOptions& options;
  const ReadingLimit& limit;
  const RadiiSet* radii = nullptr;  ///< null for the set that the options name

  void check() const {
    if (options.check) options.check();
  }
  /// Throws Error if this number of additional bytes exceeds the memory limit.
  void require_memory(std::uint64_t bytes) const { limit.require(bytes, reading_of(name)); }
};

/// Returns the version of gemmi; empty in a build without it, which reads no PDB and mmCIF files.
std::string_view gemmi_version();

/// Reads a text. Calls `after_part` after each part with the atoms so far. Labels that `after_part`
/// takes are not kept. Throws Error with file and line.
AtomFile read_structure(StructureText text, const std::function<void(AtomFile& atoms)>& after_part);

/// Returns the names of the models of a text, in its order; empty if it has no atoms. Throws Error
/// with file and line.
std::vector<std::string> read_model_names(StructureText text);

}  // namespace eses::detail
