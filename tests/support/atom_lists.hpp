#pragma once
/// Reads the atoms of a file or a text without lines and labels, and checks of atoms and messages.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "eses/error.hpp"
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

/// Returns the message of the error, or "" if nothing is thrown.
template <class Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (const eses::Error& error) {
    return error.what();
  }
  return {};
}

inline std::vector<Atom> xyzr(std::string_view text) {
  return parse_atom_list(text, AtomFormat::xyzr, "t.xyzr");
}

inline std::vector<Atom> pqr(std::string_view text) {
  return parse_atom_list(text, AtomFormat::pqr, "t.pqr");
}

inline bool is_atom(const Atom& atom, double x, double y, double z, double radius) {
  return atom.center == eses::Vec3{x, y, z} && atom.radius == radius;
}

inline bool is_sole_atom(const std::vector<Atom>& atoms, double x, double y, double z,
                         double radius) {
  return atoms.size() == 1 && is_atom(atoms[0], x, y, z, radius);
}

}  // namespace eses::detail::test
