#include "mesh/atom_groups.hpp"

#include <fmt/format.h>

#include <string_view>
#include <unordered_map>

namespace eses::mesh {
namespace {

// Names whose numbers are the order in which they come.
class NameNumbers {
 public:
  explicit NameNumbers(std::vector<std::string>& names) : names_(names) {}

  std::uint32_t number_of(const std::string& name) {
    const auto [found, is_new] =
        numbers_.try_emplace(name, static_cast<std::uint32_t>(names_.size()));
    if (is_new) names_.push_back(name);
    return found->second;
  }

 private:
  std::vector<std::string>& names_;
  std::unordered_map<std::string, std::uint32_t> numbers_;
};

// Readers of PLY files have room for lines of some length only.
std::string_view shortened(std::string_view name) {
  constexpr std::size_t longest_name = 64;  // characters
  return name.substr(0, longest_name);
}

}  // namespace

AtomGroups group_atoms(std::span<const AtomLabel> labels) {
  AtomGroups groups;
  groups.chain_of.reserve(labels.size());
  groups.residue_of.reserve(labels.size());
  NameNumbers chains(groups.chains), residues(groups.residues);
  for (const AtomLabel& label : labels) {
    const std::string_view chain = shortened(label.chain);
    groups.chain_of.push_back(chains.number_of(std::string(chain)));
    groups.residue_of.push_back(residues.number_of(
        fmt::format("{} {} {}", shortened(label.residue), shortened(label.residue_number), chain)));
  }
  return groups;
}

}  // namespace eses::mesh
