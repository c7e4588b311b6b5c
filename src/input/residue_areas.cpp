#include "eses/residue_areas.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "input/residue_atoms.hpp"

namespace eses {

std::string_view source_of(AreaReference reference) {
  switch (reference) {
    case AreaReference::miller:
      return "Miller et al. 1987, doi:10.1016/0022-2836(87)90038-6";
    case AreaReference::sander:
      return "Rost and Sander 1994, doi:10.1002/prot.340200303";
    case AreaReference::tien:
      break;
  }
  return "Tien et al. 2013, theoretical values, doi:10.1371/journal.pone.0080635";
}

namespace {

/// Returns the standard residue of the same size and shape: selenium in the place of sulfur, and
/// the mirror images of D-amino acids. Returns other names as they are.
std::string_view residue_of_same_area(std::string_view residue) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 21> same{
      {{"MSE", "MET"}, {"SEC", "CYS"}, {"DAL", "ALA"}, {"DAR", "ARG"}, {"DAS", "ASP"},
       {"DCY", "CYS"}, {"DGL", "GLU"}, {"DGN", "GLN"}, {"DHI", "HIS"}, {"DIL", "ILE"},
       {"DLE", "LEU"}, {"DLY", "LYS"}, {"DPN", "PHE"}, {"DPR", "PRO"}, {"DSG", "ASN"},
       {"DSN", "SER"}, {"DTH", "THR"}, {"DTR", "TRP"}, {"DTY", "TYR"}, {"DVA", "VAL"},
       {"MED", "MET"}}};
  const auto* const found = std::ranges::find(same, residue, &decltype(same)::value_type::first);
  return found == same.end() ? residue : found->second;
}

/// Returns the maximum area of a residue, whose name in force fields is replaced by the standard
/// one.
std::optional<double> area_of(std::string_view name, AreaReference reference) {
  const std::string_view residue = residue_of_same_area(name);
  struct Maximum {
    std::string_view residue;
    std::array<double, 3> areas;  // by AreaReference
  };
  constexpr std::array<Maximum, 20> maxima{
      {{"ALA", {129, 113, 106}}, {"ARG", {274, 241, 248}}, {"ASN", {195, 158, 157}},
       {"ASP", {193, 151, 163}}, {"CYS", {167, 140, 135}}, {"GLN", {225, 189, 198}},
       {"GLU", {223, 183, 194}}, {"GLY", {104, 85, 84}},   {"HIS", {224, 194, 184}},
       {"ILE", {197, 182, 169}}, {"LEU", {201, 180, 164}}, {"LYS", {236, 211, 205}},
       {"MET", {224, 204, 188}}, {"PHE", {240, 218, 197}}, {"PRO", {159, 143, 136}},
       {"SER", {155, 122, 130}}, {"THR", {172, 146, 142}}, {"TRP", {285, 259, 227}},
       {"TYR", {263, 229, 222}}, {"VAL", {174, 160, 142}}}};
  const auto* const found = std::ranges::find(maxima, residue, &Maximum::residue);
  if (found == maxima.end()) return std::nullopt;
  return found->areas[static_cast<std::size_t>(reference)];
}

}  // namespace

std::optional<double> max_sas_area(std::string_view residue, AreaReference reference) {
  return area_of(detail::standard_residue(residue), reference);
}

std::optional<double> max_sas_area(std::span<const AtomLabel> residue, AreaReference reference) {
  return residue.empty() ? std::nullopt : area_of(detail::standard_residue(residue), reference);
}

}  // namespace eses
