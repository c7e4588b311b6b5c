#pragma once
/// Reading of the lines of xyzr and PQR files and texts.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "eses/read_atoms.hpp"
#include "input/atom_names.hpp"

namespace eses::detail {

/// How the lines of an xyzr or PQR file are read.
struct AtomLines {
  const ReadOptions& options;
  std::string_view name;  ///< name of the file, for messages
  /// Whether the user has chosen the format, so that the text is not taken for another one.
  bool is_chosen = false;
};

/// Fills a part of a buffer and returns the number of characters; 0 at the end of the text.
using ReadText = std::function<std::size_t(std::span<char> buffer)>;

/// Reads a whole file. Besides the atoms, the memory does not grow with the file. Calls the check
/// of the options after each part. Throws Error as read_atoms does.
AtomFile read_all_atoms(const ReadText& read, const AtomLines& lines, const NameStore& store = {});

/// Adds a line with coordinates whose record name is unknown to the diagnostics.
void add_unread_record(std::uint64_t line, AtomFile& file);

/// Reads a text in memory, which must outlive the result.
ReadText text_in_memory(std::string_view text);

/// Returns the message for a file of this number of lines without atoms, or without atoms in the
/// chosen model.
std::string no_atoms_message(std::string_view name, AtomFormat format, std::uint64_t lines,
                             int model = 0);

}  // namespace eses::detail
