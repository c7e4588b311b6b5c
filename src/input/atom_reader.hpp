#pragma once
/// Reading of the lines of xyzr and PQR files and texts.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "eses/read_atoms.hpp"
#include "input/pqr_records.hpp"

namespace eses::detail {

/// The lines of an xyzr or PQR file, or of a part of it.
struct AtomLines {
  const ReadOptions& options;
  std::string_view name;         ///< name of the file, for messages
  std::uint64_t first_line = 1;  ///< number of the first line in the file, from 1
  /// Whether the user has chosen the format, so that the text is not taken for another one.
  bool is_chosen = false;
};

/// Counts of a text that was read.
struct LinesRead {
  std::uint64_t lines = 0;
  PdbLikeness likeness;
  std::uint64_t models = 0;  ///< number of MODEL records
  /// Number of the model at the end of the text. Atoms outside of all models belong to model 1.
  int last_model = 1;
  NamedColumns columns = {};  ///< the columns of charge and radius, if remarks name them
};

/// Fills a part of a buffer and returns the number of characters; 0 at the end of the text.
using ReadText = std::function<std::size_t(std::span<char> buffer)>;

/// Appends the atoms of a text to `result`. The memory does not grow with the text. Calls
/// `after_part` after each part. Throws Error as read_atoms does, except for files without atoms
/// and for PDB files.
LinesRead read_atom_lines(const ReadText& read, const AtomLines& lines, AtomFile& result,
                          const std::function<void()>& after_part = {});

/// Throws Error if a file, all of which was read, has no atoms, has several models of which none
/// was chosen, or is a PDB file.
void require_atoms(const AtomLines& lines, std::uint64_t atoms, const LinesRead& read);

/// Reads a whole file, with the checks of require_atoms. Calls the check of the options and
/// `after_part` after each part.
AtomFile read_all_atoms(const ReadText& read, const AtomLines& lines,
                        const std::function<void(AtomFile& atoms)>& after_part = {});

/// Adds a line with coordinates whose record name is unknown to the diagnostics.
void add_unread_record(std::uint64_t line, AtomFile& file);

/// Reads a text in memory, which must outlive the result.
ReadText text_in_memory(std::string_view text);

/// Returns the message for a file of this number of lines without atoms, or without atoms in the
/// chosen model.
std::string no_atoms_message(std::string_view name, AtomFormat format, std::uint64_t lines,
                             int model = 0);

}  // namespace eses::detail
