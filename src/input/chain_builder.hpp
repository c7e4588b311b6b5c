#pragma once
/// Construction of gemmi's chains, atom by atom. This header is valid C++17, for the reason given
/// in mmcif_text.cpp.

#include <cstddef>
#include <gemmi/model.hpp>
#include <string>
#include <unordered_map>

namespace eses::detail {

/// Finds the residues of the chain to which atoms are being added.
class ChainBuilder {
 public:
  /// The chain; null before the first one and after end().
  gemmi::Chain* chain() const { return chain_; }

  /// Returns whether the chain has this name.
  bool is_in(const std::string& name) const { return chain_ != nullptr && chain_->name == name; }

  /// Appends a chain to `model`. An earlier chain may have the same name.
  void begin(gemmi::Model& model, const std::string& name);

  void end() { chain_ = nullptr; }

  /// Returns the residue of the chain with this identity. A new residue has no atoms.
  gemmi::Residue& residue(const gemmi::ResidueId& id);

 private:
  gemmi::Chain* chain_ = nullptr;
  std::size_t residue_ = 0;                                    // index of the last residue
  std::unordered_map<gemmi::ResidueId, std::size_t> indices_;  // of all residues of the chain
};

/// Splits residues in which an atom of the same name and alternate location repeats. They are
/// several residues with the same name and number, because in large files numbers begin again after
/// 9999.
void split_residues(gemmi::Structure& structure);

}  // namespace eses::detail
