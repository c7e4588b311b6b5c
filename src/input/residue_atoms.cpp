#include "input/residue_atoms.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "eses/residue_areas.hpp"
#include "input/radii_tables.hpp"

namespace eses::detail {
namespace {

// Forms of amino acids and nucleotides in force fields, and the standard residue with the same
// heavy atoms.
constexpr std::array<std::pair<std::string_view, std::string_view>, 12> forms{{
    {"A", "ADE"},
    {"ARG", "ARN ARGN"},
    {"ASP", "ASH ASPH ASB ASPP"},
    {"C", "CYT"},
    {"CYS", "CYX CYM CYN CYSH CYS2 CYH CYP CY2 CYSD"},
    {"DT", "THY T"},
    {"G", "GUA"},
    {"GLU", "GLH GLUH GLUP"},
    {"HIS", "HID HIE HIP HSD HSE HSP HSC HIN HDP HISA HISB HISD HISE HISH HISN HISL HIS1 HIS2"},
    {"LYS", "LYN LYSH LYP LYSN"},
    {"TYR", "TYM TYRH"},
    {"U", "URA"},
}};

// Further names: ends and caps of chains, isoleucine in CHARMM and GROMACS, atoms of uncertain
// element in old files, lone pairs, selenium in the place of sulfur, and phosphates.
constexpr std::string_view of_amino_acids =
    "OT OT1 OT2 OTX OXT NT CAT CAY CY OY O1 O2 O' O'' OC1 OC2 CD AD1 AD2 AE1 AE2 LP1 LP2 SE P O1P "
    "O2P O3P OP1 OP2 "
    "OP3";
// Further names of nucleotides, with the methyl group of thymine and the oxygen of ribose.
constexpr std::string_view of_nucleotides = "O1P O2P O3P O5T O3T O2' C5M C7 CM5";

}  // namespace

std::string_view standard_residue(std::string_view residue) {
  const auto find = [](std::string_view name) {
    return std::find_if(forms.begin(), forms.end(),
                        [name](const auto& form) { return has_word(form.second, name); });
  };
  if (const auto found = find(residue); found != forms.end()) return found->first;
  if (is_named_polymer(residue)) residue = without_end_letter(residue);
  if (const auto found = find(residue); found != forms.end()) return found->first;
  constexpr std::string_view bases = "ACGIUT";
  std::string_view base = residue;
  if (base.size() > 1 && std::string_view("35N").find(base.back()) != base.npos)
    base.remove_suffix(1);
  if (base.size() == 2 && base.front() == 'R') base.remove_prefix(1);
  const bool is_base = (base.size() == 1 || (base.size() == 2 && base.front() == 'D')) &&
                       bases.find(base.back()) != bases.npos;
  return is_base ? base : residue;
}

std::string_view standard_residue(std::span<const AtomLabel> residue) {
  const std::string_view name = residue.front().residue;
  const bool is_other = is_other_molecule(
      name, residue, [](const AtomLabel& atom) { return std::string_view(atom.atom_name); });
  return is_other ? name : standard_residue(name);
}

std::string_view telling_atoms(std::string_view residue) {
  if (without_end_letter(residue) == "HSE") return "ND1 NE2";
  constexpr std::string_view nucleotides = "ADE CYT GUA THY URA DGN";
  return has_word(nucleotides, residue) ? "C1' C1*" : "";
}

std::string standard_atom(std::string_view residue, std::string_view atom) {
  if (!is_named_polymer(residue)) return std::string(atom);
  if (residue.size() > 2) {
    if (atom == "OT" || atom == "OT1" || atom == "OC1" || atom == "O1" || atom == "O'") return "O";
    if (atom == "OT2" || atom == "OC2" || atom == "O2" || atom == "O''" || atom == "OTX")
      return "OXT";
    return std::string(residue == "ILE" && atom == "CD" ? "CD1" : atom);
  }
  if (atom == "O1P" || atom == "O2P" || atom == "O3P") return std::string("OP").append(1, atom[1]);
  if (atom == "O5T") return "O5'";
  if (atom == "O3T") return "O3'";
  if (atom == "C5M" || atom == "CM5") return "C7";
  std::string name(atom);
  std::replace(name.begin(), name.end(), '*', '\'');
  return name;
}

bool may_have_atom(std::string_view residue, std::string_view atom) {
  const bool is_amino_acid = residue.size() == 3 && protor_radius(residue, "N");
  const bool is_nucleotide = residue.size() < 3 && protor_radius(residue, "P");
  if (!is_amino_acid && !is_nucleotide) return true;
  std::string name(atom);
  std::replace(name.begin(), name.end(), '*', '\'');
  return protor_radius(residue, name) ||
         has_word(is_amino_acid ? of_amino_acids : of_nucleotides, name);
}

bool is_backbone_atom(std::string_view atom) {
  constexpr std::string_view backbone =
      "N CA C O P O5' C5' C4' O4' C3' O3' C2' C1' O5* C5* C4* O4* C3* O3* C2* C1*";
  return has_word(backbone, atom);
}

}  // namespace eses::detail

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
