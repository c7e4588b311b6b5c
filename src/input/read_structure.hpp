#pragma once
/// Reading of atoms from PDB and mmCIF texts.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "eses/read_atoms.hpp"
#include "input/atom_names.hpp"
#include "input/text_source.hpp"

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

/// Reads a text. The labels go to `store`, if it is used. Throws Error with file and line.
AtomFile read_structure(StructureText text, const NameStore& store = {});

/// Returns the names of the models of a text, in its order; empty if it has no atoms. Throws Error
/// with file and line.
std::vector<std::string> read_model_names(StructureText text);

}  // namespace eses::detail
