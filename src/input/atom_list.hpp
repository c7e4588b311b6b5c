#pragma once
/// Conversion of gemmi's atoms to SelectedStructure.

#include <cstdint>
#include <gemmi/model.hpp>
#include <string>
#include <string_view>
#include <unordered_map>

#include "input/parse_structure.hpp"

namespace eses::detail {

/// Appends residues and atoms to a SelectedStructure.
class AtomList {
 public:
  /// `file` is the name of the file for messages. Both must outlive the list.
  AtomList(SelectedStructure& result, std::string_view file) : result_(result), file_(file) {}

  /// Adds a residue of the chain `chain`, to which the next atoms belong.
  void add_residue(const std::string& chain, const gemmi::Residue& residue);

  /// Adds an atom at the position `at`. The serial number of the atom is its line number. Throws
  /// Error if a coordinate is too large or not finite.
  void add_atom(const gemmi::Atom& atom, const gemmi::Position& at);

 private:
  std::uint32_t name_index(const std::string& name);

  SelectedStructure& result_;
  std::string_view file_;
  std::unordered_map<std::string, std::uint32_t> names_;
};

}  // namespace eses::detail
