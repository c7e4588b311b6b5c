#pragma once
/// Reading of xyzr and PQR files and texts. Implemented in atom_reader.cpp.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "eses/read_atoms.hpp"

namespace eses::detail {

/// Parameters for reading the lines of an xyzr or PQR file.
struct AtomLines {
  AtomFormat format = AtomFormat::xyzr;
  std::string_view name;         ///< name of the file, for messages
  std::uint64_t first_line = 1;  ///< number of the first line in the file, from 1
  /// Whether to read labels and charges; only PQR files have them. The element of a label is that
  /// of the file, without its charge, or empty.
  bool with_labels = false;
  std::uint64_t max_memory = 0;  ///< see ReadOptions::max_memory
  int model = 0;                 ///< see StructureOptions::model; only for PQR files
  /// Number of the model at the start of the text. Atoms outside of all models belong to model 1.
  int model_before = 1;
};

/// Counts of PQR records that look like records of a PDB file.
struct PdbLikeness {
  /// Number of records that have numbers in the columns and format of occupancy and B-factor.
  std::uint64_t layout = 0;
  /// Number of these records whose values are improbable as charge and radius.
  std::uint64_t values = 0;
};

/// Counts of a text that was read.
struct LinesRead {
  std::uint64_t lines = 0;
  PdbLikeness likeness;
  std::uint64_t models = 0;  ///< number of MODEL records
  int last_model = 0;        ///< number of the model at the end of the text
};

/// Fills a part of a buffer and returns the number of characters; 0 at the end of the text.
using ReadText = std::function<std::size_t(std::span<char> buffer)>;

/// Appends the atoms of a text to `result`. The memory does not grow with the text. Calls
/// `after_part` after each part. Throws Error as read_atoms does, except for files without atoms
/// and for PDB files.
LinesRead read_atom_lines(const ReadText& read, const AtomLines& lines, AtomFile& result,
                          const std::function<void()>& after_part = {});

/// Does the same for a text in memory, which must consist of whole lines.
LinesRead parse_atom_lines(std::string_view text, const AtomLines& lines, AtomFile& result);

/// Implements read_atoms for xyzr and PQR files. Calls `after_part` after each part with the atoms
/// read so far.
AtomFile read_atom_file(const std::filesystem::path& path, const ReadOptions& options,
                        const std::function<void(AtomFile& atoms)>& after_part);

/// Implements parse_atoms for xyzr and PQR, with the format, name and labels of `lines`.
AtomFile parse_atom_text(std::string_view text, const AtomLines& lines);

/// Returns `format` or, if it is automatic, the format by the suffix of the path without .gz.
AtomFormat format_of(const std::filesystem::path& path, AtomFormat format);

/// Returns whether a path has the suffix of an assembly file of the PDB, such as .pdb1 or .pdb2.gz.
bool is_assembly_file(const std::filesystem::path& path);

/// Returns the limit of the resident memory while the process reads, in bytes; 0 if `max_memory` is
/// 0. Reading may always add a few MiB.
std::uint64_t max_resident_while_reading(std::uint64_t max_memory);

/// Throws Error if a PQR file has several models and none was chosen.
void refuse_models(std::string_view name, std::uint64_t models);

/// Throws Error if most of the `atoms` records of a PQR file look like records of a PDB file.
void refuse_pdb_records(std::string_view name, std::uint64_t atoms, const PdbLikeness& likeness);

/// Throws Error if the records of a text, which should be a PDB file, are those of a PQR file.
void refuse_pqr_records(std::string_view text, std::string_view name);

/// Returns the message for a file of this number of lines without atoms, or without atoms in the
/// chosen model.
std::string no_atoms_message(std::string_view name, AtomFormat format, std::uint64_t lines,
                             int model = 0);

}  // namespace eses::detail
