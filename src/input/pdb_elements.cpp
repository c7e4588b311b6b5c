#include "input/pdb_elements.hpp"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "eses/atoms.hpp"
#include "input/radii_tables.hpp"
#include "input/text_fields.hpp"

namespace eses::detail {
namespace {

// Amino acids and nucleotides of the PDB, and their names in the force fields of Amber, CHARMM and
// GROMACS: protonation states, caps of chains, and nucleotides.
constexpr std::string_view polymer_residues =
    "ALA ARG ASN ASP CYS GLN GLU GLY HIS ILE LEU LYS MET PHE PRO SER THR TRP TYR VAL ASX GLX PYL "
    "SEC MSE SEP TPO PTR A C G I U DA DC DG DI DT DU HID HIE HIP HSD HSE HSP HSC HIN HDP CYX CYM "
    "CYN CYH CYP CY2 ASH ASB GLH LYN LYP ARN TYM ACE NME NMA NHE NH2 FOR CT3 A3 A5 AN C3 C5 CN G3 "
    "G5 GN U3 U5 UN RA RC RG RU RA3 RA5 RC3 RC5 RG3 RG5 RU3 RU5 DA3 DA5 DC3 DC5 DG3 DG5 DT3 DT5";

struct NamedIon {
  std::string_view name, element;
};

// Names of ions in the force fields of CHARMM, Amber (C0) and SIRAH.
constexpr std::array<NamedIon, 16> named_ions{{{"SOD", "NA"},
                                               {"CLA", "CL"},
                                               {"POT", "K"},
                                               {"CAL", "CA"},
                                               {"CES", "CS"},
                                               {"LIT", "LI"},
                                               {"RUB", "RB"},
                                               {"BAR", "BA"},
                                               {"CAD", "CD"},
                                               {"C0", "CA"},
                                               {"NAW", "NA"},
                                               {"CLW", "CL"},
                                               {"KW", "K"},
                                               {"MGX", "MG"},
                                               {"CAX", "CA"},
                                               {"ZNX", "ZN"}}};

// Elements of two letters that are usually meant by these names in ligands, although the first
// letter is an element, too. Iron is one in all columns.
constexpr std::string_view left_aligned_elements = "CL BR CU NI SI SE PT PD IR OS";

// Some of them are also meant where the name begins in the second column, as GROMACS and others
// write it, if the symbol is the whole name or a digit follows.
// The first letter of the symbols from MG on is no element.
constexpr std::string_view shifted_elements =
    "CL BR SI SE MG MN MO ZN ZR AG AL AS AU EU GA GD RB RE RH RU TB TI TL";

// Names of amino acids with four letters in GROMACS and CHARMM, and of water.
constexpr std::string_view long_residues =
    "ARGN ASPH ASPP CYS2 CYSD CYSH GLUH GLUP HIS1 HIS2 HISA HISB HISD HISE HISH LYSH LYSN TYRH";
constexpr std::string_view long_waters = "TIP2 TIP3 TIP4 TIP5 SPCE";

// Names of water in coarse-grained force fields. Martini 2 and 3 have beads, beads against
// freezing, polarizable, small and tiny ones; the last name is that of SIRAH.
constexpr std::string_view water_beads = "W WF PW SW TW WT4";

bool is_element(std::string_view symbol) { return !usual_spelling(symbol).empty(); }

/// Returns the name without the digits and signs around its letters.
std::string_view stem_of(std::string_view name) {
  while (!name.empty() && !is_letter(name.front())) name.remove_prefix(1);
  while (!name.empty() && !is_letter(name.back())) name.remove_suffix(1);
  return name;
}

std::string ion_element(std::string_view name) {
  const std::string stem = upper_case(std::string(stem_of(name)));
  for (const NamedIon& ion : named_ions)
    if (stem == ion.name || name == ion.name) return std::string(ion.element);
  return stem.size() <= 2 && is_element(stem) ? stem : std::string();
}

/// Returns the element of an atom that is not of a polymer and whose name begins with `H` or `D`.
/// Names of hydrogens are often misaligned, so only `HG` in the first column is mercury. `DU` is a
/// dummy atom.
std::string hydrogen_or_mercury(std::string_view name_columns, std::string_view name,
                                bool is_left_aligned) {
  if (stem_of(name) == "DU") return "X";
  const bool is_mercury =
      stem_of(name) == "HG" && name_columns.starts_with("HG") && name_columns.ends_with(' ');
  return is_mercury && !is_left_aligned ? "HG" : std::string(1, name.front());
}

/// Returns the symbol in capital letters if a name begins with a symbol whose second letter is
/// small, such as `Cl1`; empty otherwise. `Ca` and `Nd` may be Greek letters of carbon and
/// nitrogen.
std::string mixed_case_element(std::string_view name) {
  constexpr std::string_view greek = "abdeghz";
  if (name.size() < 2 || name[0] > 'Z' || name[1] < 'a' || name[1] > 'z') return {};
  const bool is_ambiguous = std::string_view("CNO").find(name[0]) != std::string_view::npos &&
                            greek.find(name[1]) != greek.npos;
  if (is_ambiguous || !is_element(name.substr(0, 2))) return {};
  return {name[0], static_cast<char>(name[1] - 'a' + 'A')};
}

/// Returns the element of an atom that is not of a polymer; empty if the columns of the name
/// decide.
std::string ligand_element(std::string_view name, bool is_left_aligned) {
  const std::string_view stem = stem_of(name);
  if (stem == "FE") return "FE";  // CHARMM writes it in the second column
  if (std::string element = mixed_case_element(name); !element.empty()) return element;
  const std::string_view start = name.substr(0, 2);
  if (has_word(shifted_elements, start) && (name.size() == 2 || is_digit(name[2])))
    return std::string(start);
  if (!is_left_aligned) return {};
  if (start == "CL" || start == "BR" || has_word(left_aligned_elements, stem))
    return std::string(start);
  constexpr std::string_view elements = "CNOSPFIB";
  return std::string(elements.find(name.front()) == elements.npos ? "" : name.substr(0, 1));
}

}  // namespace

bool is_named_polymer(std::string_view residue) {
  return has_word(polymer_residues, without_end_letter(residue)) ||
         has_word(long_residues, residue);
}

bool is_known_long_residue(std::string_view name) {
  return name.size() == 4 && (is_named_polymer(name) || has_word(long_waters, name));
}

bool is_long_residue(std::string_view name) {
  if (name.size() != 4) return false;
  const std::string_view start = trimmed(name.substr(0, 3));
  return is_known_long_residue(name) || !(is_named_polymer(start) || start == "HOH");
}

ResidueColumns split_residue(std::string_view record, bool may_be_long,
                             bool (*is_long_name)(std::string_view name)) {
  const std::string_view columns = record.substr(17, 5);
  const auto is_filled = [](std::string_view text) {
    return text.size() == 4 && std::none_of(text.begin(), text.end(), is_blank);
  };
  if (const std::string_view name = columns.substr(0, 4);
      may_be_long && is_filled(name) && is_long_name(name))
    return {name, trimmed(columns.substr(4)), true};
  if (const std::string_view name = columns.substr(1);
      may_be_long && is_blank(columns.front()) && is_filled(name) && is_known_long_residue(name))
    return {name, {}, true};
  // No chain has a sign as its name.
  if (columns[3] == '+' || columns[3] == '-')
    return {trimmed(columns.substr(0, 4)), trimmed(columns.substr(4)), true};
  return {trimmed(columns.substr(0, 3)), trimmed(columns.substr(3)), false};
}

bool is_water_bead(std::string_view residue) { return has_word(water_beads, residue); }

bool is_ion(const NamedAtom& atom) {
  if (is_water_bead(atom.residue)) return false;
  const std::string_view name = trimmed(atom.name_columns), residue = atom.residue;
  if (atom.is_polymer) return name == residue;
  const std::string stem = lower_case(std::string(stem_of(name)));
  if (!stem.empty() && stem == lower_case(std::string(stem_of(residue)))) return true;
  const std::string element = ion_element(name);
  if (element.empty()) return false;
  if (residue == "ION" || residue == "IONS") return true;
  return atom.is_alone &&
         (name.ends_with('+') || name.ends_with('-') || element == ion_element(residue));
}

std::string element_by_name(const NamedAtom& atom) {
  const auto& [name_columns, residue, is_polymer, is_alone, is_left_aligned] = atom;
  std::string_view name = trimmed(name_columns);
  if (stem_of(name) == "UNK") return "X";  // the unknown atom of the residue UNX
  if (is_ion(atom)) return ion_element(name);
  if (is_water_bead(residue)) return "O";
  while (!name.empty() && is_digit(name.front())) name.remove_prefix(1);
  if (name.empty()) return {};
  if (name.front() == 'H' || name.front() == 'D')
    return is_polymer ? std::string(1, name.front())
                      : hydrogen_or_mercury(name_columns, name, is_left_aligned);
  if (!is_polymer) return ligand_element(name, is_left_aligned);
  for (const std::string_view element : {"SE", "CL", "BR"})
    if (stem_of(name) == element) return std::string(element);
  constexpr std::string_view elements = "CNOSP";
  return std::string(elements.find(name.front()) == elements.npos ? "" : name.substr(0, 1));
}

std::string usual_spelling(std::string_view text) {
  const bool has_two = text.size() > 1 && (is_letter(text[1]) || is_digit(text[1]));
  std::string symbol = lower_case(std::string(text.substr(0, has_two ? 2 : 1)));
  if (!symbol.empty() && is_letter(symbol[0])) symbol[0] = static_cast<char>(symbol[0] - 'a' + 'A');
  return freesasa_element_radius(symbol) ? symbol : std::string();
}

std::string symbol_by_name(std::string_view name, std::string_view residue) {
  const bool is_polymer = is_named_polymer(residue);
  if (const std::string symbol = element_by_name({name, residue, is_polymer}); !symbol.empty())
    return usual_spelling(symbol);
  const std::string_view stem = stem_of(name);
  const std::string symbol = usual_spelling(stem);
  // In the columns of a PDB file, BB has its first letter where the element is.
  return symbol.empty() && is_polymer ? usual_spelling(stem.substr(0, 1)) : symbol;
}

void complete_elements(std::vector<AtomLabel>& labels) {
  std::unordered_map<std::string, std::string> by_names;
  for (AtomLabel& label : labels) {
    label.element = usual_spelling(label.element);
    if (!label.element.empty()) continue;
    const auto [known, is_new] = by_names.try_emplace(label.residue + '\0' + label.atom_name);
    if (is_new) known->second = symbol_by_name(label.atom_name, label.residue);
    label.element = known->second;
  }
}

}  // namespace eses::detail
