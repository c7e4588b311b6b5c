#include "input/chain_builder.hpp"

#include <set>
#include <utility>
#include <vector>

namespace eses::detail {

void ChainBuilder::begin(gemmi::Model& model, const std::string& name) {
  chain_ = &model.chains.emplace_back(name);
  indices_.clear();
}

gemmi::Residue& ChainBuilder::residue(const gemmi::ResidueId& id) {
  std::vector<gemmi::Residue>& residues = chain_->residues;
  if (!residues.empty() && residues[residue_].matches(id)) return residues[residue_];
  const auto [found, is_new] = indices_.emplace(id, residues.size());
  residue_ = found->second;
  return is_new ? residues.emplace_back(id) : residues[residue_];
}

void split_residues(gemmi::Structure& structure) {
  std::set<std::pair<std::string, char>> known;
  for (gemmi::Model& model : structure.models)
    for (gemmi::Chain& chain : model.chains) {
      std::vector<gemmi::Residue> parts;
      parts.reserve(chain.residues.size());
      for (gemmi::Residue& residue : chain.residues) {
        std::vector<gemmi::Atom> atoms = std::move(residue.atoms);
        known.clear();
        for (gemmi::Atom& atom : atoms) {
          const bool is_repeated = !known.emplace(atom.name, atom.altloc).second;
          if (is_repeated) known = {{atom.name, atom.altloc}};
          if (is_repeated || &atom == &atoms.front()) {
            parts.push_back(residue.empty_copy());
            parts.back().entity_id = residue.entity_id;
          }
          parts.back().atoms.push_back(std::move(atom));
        }
      }
      // The atoms stay in memory until the result is complete.
      for (gemmi::Residue& part : parts) part.atoms.shrink_to_fit();
      chain.residues = std::move(parts);
    }
}

}  // namespace eses::detail
