#pragma once
/// Reading atoms from xyzr and PQR files.

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "eses/atom_labels.hpp"
#include "eses/atoms.hpp"

namespace eses {

enum class AtomFormat {
  automatic,  ///< by the file's suffix: `.pqr` is PQR, everything else xyzr
  xyzr,       ///< one atom a line, `x y z r`; further columns, blank and `#` lines are ignored
  pqr,        ///< ATOM and HETATM records; the last two numbers, before an element symbol if there
              ///< is one, are charge and radius
};

/// Atoms, where they stand and what they are called.
struct NumberedAtoms {
  std::vector<Atom> atoms;
  std::vector<std::uint64_t> lines;  ///< of each atom, 1-based
  std::vector<AtomLabel> labels;     ///< of each atom, if the file is PQR; else empty
};

/// What is read of a file, and in how much memory.
struct ReadOptions {
  AtomFormat format = AtomFormat::automatic;
  bool with_labels = true;  ///< of PQR files; labels take more memory than atoms
  /// Bytes that the process may hold resident while it reads; 0: no limit. A few MiB are granted in
  /// any case.
  std::uint64_t max_memory = 0;
};

/// What a file is read as: `format`, or by its suffix, of NAME.gz that of NAME.
AtomFormat format_of(const std::filesystem::path& path, AtomFormat format);

/// Reads all atoms of a file; `-` is standard input. Throws Error, naming file, line and field,
/// if the file cannot be read, holds no atom, has a field that is missing, not a finite number, or
/// a negative radius, is a PDB file, or takes more memory than allowed.
NumberedAtoms read_numbered_atoms(const std::filesystem::path& path, const ReadOptions& options);
NumberedAtoms read_numbered_atoms(const std::filesystem::path& path,
                                  AtomFormat format = AtomFormat::automatic);
std::vector<Atom> read_atoms(const std::filesystem::path& path,
                             AtomFormat format = AtomFormat::automatic);

/// The same for text that is already in memory; `name` stands for the file in messages, and
/// `automatic` means xyzr.
NumberedAtoms parse_numbered_atoms(std::string_view text, AtomFormat format, std::string_view name);
std::vector<Atom> parse_atoms(std::string_view text, AtomFormat format, std::string_view name);

}  // namespace eses
