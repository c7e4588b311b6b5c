#pragma once
/// Returns the atoms of a file or a text without lines and labels.

#include <filesystem>
#include <string_view>
#include <vector>

#include "eses/read_atoms.hpp"

namespace eses::detail::test {

inline std::vector<Atom> read_atom_list(const std::filesystem::path& path,
                                        AtomFormat format = AtomFormat::automatic) {
  return read_atoms(path, {.format = format, .with_labels = false}).atoms;
}

inline std::vector<Atom> parse_atom_list(std::string_view text, AtomFormat format,
                                         std::string_view name) {
  return parse_atoms(text, format, name).atoms;
}

}  // namespace eses::detail::test
