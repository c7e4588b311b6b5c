#pragma once
/// Reading atoms from text that arrives in pieces.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "eses/read_atoms.hpp"

namespace eses::detail {

/// How the lines of an atom file are read.
struct AtomLines {
  AtomFormat format = AtomFormat::xyzr;
  std::string_view name;         ///< of the file, in messages
  std::uint64_t first_line = 1;  ///< number of the first line in the file, 1-based
  bool with_labels = false;      ///< only PQR has labels
  std::uint64_t max_memory = 0;  ///< see ReadOptions
  int model = 0;                 ///< see StructureOptions; only PQR has models
  /// Number of the model in whose records the text begins. What is in no model is in model 1.
  int model_before = 1;
};

/// Counts of PQR records that look like those of a PDB file.
struct PdbLikeness {
  /// Records with numbers where PDB files have occupancy and B-factor, as these are written there.
  std::uint64_t layout = 0;
  /// Of these, records whose numbers are improbable as charge and radius.
  std::uint64_t values = 0;
};

struct LinesRead {
  std::uint64_t lines = 0;
  PdbLikeness likeness;
  std::uint64_t models = 0;  ///< MODEL records
  int last_model = 0;        ///< number of the model in whose records the text ends
};

/// Fills a part of a buffer and returns the number of characters; 0 at the end of the text.
using ReadText = std::function<std::size_t(std::span<char> buffer)>;

/// Appends the atoms of a text to `result`, in memory that does not grow with the text, and calls
/// `after_part` now and then. Throws Error as read_atoms does, but not if there is no
/// atom, nor if the text is a PDB file.
LinesRead read_atom_lines(const ReadText& read, const AtomLines& lines, AtomFile& result,
                          const std::function<void()>& after_part = {});

/// The same for a text in memory, which must consist of whole lines.
LinesRead parse_atom_lines(std::string_view text, const AtomLines& lines, AtomFile& result);

/// read_atoms, which calls `after_part` now and then with what it has read so far.
AtomFile read_atom_file(const std::filesystem::path& path, const ReadOptions& options,
                        const std::function<void(AtomFile& atoms)>& after_part);

/// parse_atoms, with the format, the name and the labels that `lines` has.
AtomFile parse_atom_text(std::string_view text, const AtomLines& lines);

/// What a file is read as: `format`, or by its suffix, of NAME.gz that of NAME.
AtomFormat format_of(const std::filesystem::path& path, AtomFormat format);

/// Memory that the process may hold while it reads within a limit; 0 if that is 0. A few MiB are
/// allowed in any case.
std::uint64_t max_resident_while_reading(std::uint64_t max_memory);

/// Throws Error if a PQR file has several models, of which none is chosen.
void refuse_models(std::string_view name, std::uint64_t models);

/// Throws Error if the records of a PQR file, as many as `atoms`, are those of a PDB file.
void refuse_pdb_records(std::string_view name, std::uint64_t atoms, const PdbLikeness& likeness);

/// The message for a file that has this number of lines and no atom, or none in the model that is
/// read.
std::string no_atoms_message(std::string_view name, AtomFormat format, std::uint64_t lines,
                             int model = 0);

}  // namespace eses::detail
