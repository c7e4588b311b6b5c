#include "input/structure/segment_chains.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>

namespace eses::detail {
namespace {

/// Returns the names of the chains that are to be divided into their segments.
std::set<std::string> chains_of_segments(const gemmi::Model& model) {
  std::map<std::string, std::set<std::string>> segments;
  for (const gemmi::Chain& chain : model.chains)
    for (const gemmi::Residue& residue : chain.residues)
      if (!residue.segment.empty()) segments[chain.name].insert(residue.segment);
  std::set<std::string> chains;
  for (const auto& [chain, names] : segments)
    if (chain.empty() || names.size() > 1) chains.insert(chain);
  return chains;
}

}  // namespace

std::vector<std::string> use_segments_as_chains(gemmi::Model& model) {
  const std::set<std::string> divided = chains_of_segments(model);
  if (divided.empty()) return {};
  std::vector<std::string> names;
  std::unordered_map<std::string, std::size_t> indices;
  std::vector<gemmi::Chain> chains = std::exchange(model.chains, {});
  for (gemmi::Chain& chain : chains)
    for (gemmi::Residue& residue : chain.residues) {
      const bool is_divided = divided.contains(chain.name) && !residue.segment.empty();
      const std::string& name = is_divided ? residue.segment : chain.name;
      const auto [found, is_new] = indices.emplace(name, model.chains.size());
      if (is_new) model.chains.emplace_back(name);
      if (is_divided && !gemmi::in_vector(name, names)) names.push_back(name);
      model.chains[found->second].residues.push_back(std::move(residue));
    }
  return names;
}

}  // namespace eses::detail
