#pragma once
/// @file
/// Reading atoms from xyzr and PQR files.

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/check.hpp"

namespace eses {

/// Format of an input file.
enum class AtomFormat {
  /// The suffix decides: `.pqr` and `.pqr.gz` are PQR, everything else is xyzr.
  automatic,
  /// One atom a line: `x y z r`. Further columns, blank lines and lines with `#` are ignored.
  xyzr,
  /// ATOM and HETATM records. The last two numbers, before an element symbol if there is one, are
  /// charge and radius.
  pqr,
};

/// The atoms of a file.
struct AtomFile {
  std::vector<Atom> atoms;           ///< Atoms in the order of the file.
  std::vector<std::uint64_t> lines;  ///< Line number of each atom, from 1.
  std::vector<AtomLabel> labels;     ///< Names of each atom of a PQR file; empty otherwise.
};

/// Choices of read_atoms.
struct ReadOptions {
  AtomFormat format = AtomFormat::automatic;  ///< Format of the file.
  /// Whether labels are read from PQR files; labels take more memory than atoms.
  bool with_labels = true;
  /// Bytes that the process may hold resident while it reads; 0 for no limit. A few MiB are allowed
  /// in any case.
  std::uint64_t max_memory = 0;
  /// Called while the file is read, at least once for each piece of it.
  CheckCallback check = {};
};

/// Reads all atoms of a file, which may be gzipped; `-` is standard input. Throws Error, which
/// names file, line and field, if the file cannot be read, holds no atom, has a field that is
/// missing, not a finite number or a negative radius, is a PDB file, or takes more memory than
/// allowed. The Error is a FileError if the operating system refuses to open or read the file, and
/// a MemoryLimitError if the memory does not suffice.
AtomFile read_atoms(const std::filesystem::path& path, const ReadOptions& options = {});

/// Reads all atoms of a text in memory, with labels. `name` is the name of the text in messages;
/// AtomFormat::automatic means xyzr. Throws Error as read_atoms does.
AtomFile parse_atoms(std::string_view text, AtomFormat format = AtomFormat::automatic,
                     std::string_view name = "text");

}  // namespace eses
