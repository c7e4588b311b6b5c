#include "output/area_formats.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "eses/error.hpp"
#include "eses/radii.hpp"
#include "input/atom_names.hpp"
#include "input/pdb_elements.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

/// SAS areas of a residue, square angstrom.
struct ResidueAreas {
  double all = 0, main_chain = 0, polar = 0;
  std::optional<double> max = std::nullopt;  ///< see max_sas_area
};

bool is_in_main_chain(std::string_view atom) {
  constexpr std::array<std::string_view, 16> names{"N",   "CA",  "C",   "O",  "OXT", "OT1",
                                                   "OT2", "H",   "HN",  "H1", "H2",  "H3",
                                                   "HA",  "HA2", "HA3", "D"};
  return std::ranges::find(names, atom) != names.end();
}

/// Returns the areas of each run of atoms of a residue.
std::vector<ResidueAreas> residue_areas(const MeasuredAtoms& atoms, const ResidueRuns& runs) {
  const std::vector<bool> are_polar = find_polar_atoms(atoms.atoms, atoms.labels);
  std::vector<ResidueAreas> all;
  runs.for_each([&](const AtomLabel&, std::size_t begin, std::size_t end) {
    ResidueAreas& areas = all.emplace_back();
    areas.max = max_sas_area(atoms, begin, end);
    for (std::size_t atom = begin; atom < end; ++atom) {
      const double sas = atoms.areas.sas[atom];
      areas.all += sas;
      if (is_in_main_chain(atoms.labels[atom].atom_name)) areas.main_chain += sas;
      if (are_polar[atom]) areas.polar += sas;
    }
  });
  return all;
}

/// Number and insertion code of a residue, such as 52 and A.
struct ResidueNumber {
  std::string_view number, icode;
};

ResidueNumber split_number(std::string_view text) {
  const std::size_t digits = text.find_last_of("0123456789");
  const std::size_t length = digits == std::string_view::npos ? 0 : digits + 1;
  return {text.substr(0, length), text.substr(length)};
}

/// Returns a text with blanks before it. Throws Error if it is wider than its column.
std::string in_column(const std::string& text, std::size_t width, std::string_view what,
                      const AtomLabel& label) {
  if (text.size() > width)
    throw Error(formatted("{} {} of {} is too wide for its column; write csv or cif", what,
                          printable(text), printable(residue_name(label))));
  return formatted("{:>{}}", text, width);
}

/// Returns an absolute and a relative area; -99.9 if there is no reference.
std::string area_columns_of(double area, std::optional<double> reference, const AtomLabel& label) {
  constexpr double missing = -99.9;
  const double relative = reference ? 100 * area / *reference : missing;
  return formatted(" {} {}", in_column(formatted("{:.2f}", area), 6, "area", label),
                   in_column(formatted("{:.1f}", relative), 5, "relative area", label));
}

/// Returns whether a text in these quotation marks would end before its last character.
bool ends_quotation(std::string_view text, char mark) {
  return text.find(std::string{mark, ' '}) != text.npos;
}

/// Returns a value of a CIF file (https://www.iucr.org/resources/cif/spec/version1.1/cifsyntax).
/// `what` is the kind of the value. Throws Error if the format has no way to write the text.
std::string cif_text(std::string_view text, std::string_view what, const AtomLabel& label) {
  if (text.empty()) return ".";
  const bool is_allowed = std::ranges::all_of(
      text, [](char c) { return (c >= ' ' && c <= '~') || c == '\t' || c == '\n'; });
  if (!is_allowed || text.find("\n;") != text.npos)
    throw Error(formatted("{} {} of {} has characters that CIF files cannot hold; write csv", what,
                          printable(text), printable(residue_name(label))));
  const bool is_plain =
      text.find_first_of(" \t\n'\"#$_[];") == std::string_view::npos && text != "?" && text != ".";
  if (is_plain) return std::string(text);
  if (text.find_first_of("\t\n") == text.npos) {
    if (text.find('"') == text.npos) return formatted("\"{}\"", text);
    if (!ends_quotation(text, '\'')) return formatted("'{}'", text);
    if (!ends_quotation(text, '"')) return formatted("\"{}\"", text);
  }
  return formatted("\n;{}\n;", text);
}

/// Returns the name of an atom in its four columns: elements of one letter begin in the second.
std::string name_columns(const AtomLabel& label) {
  const bool is_indented = label.atom_name.size() < 4 && label.element.size() < 2;
  const std::string name = formatted("{}{:<4}", is_indented ? " " : "", label.atom_name);
  return in_column(name.substr(0, std::max<std::size_t>(4, label.atom_name.size())), 4, "atom name",
                   label);
}

std::string_view record_of(const AtomLabel& label) {
  return is_named_polymer(label.residue) ? "ATOM" : "HETATM";
}

}  // namespace

void append_rsa(const MeasuredAtoms& atoms, BufferedText& text) {
  text.append(
      "REM  Areas on the solvent accessible surface (square angstrom) and in per cent of the "
      "maxima of\n"
      "REM  {}. Without a maximum, as for parts: -99.9.\n"
      "REM RES _ NUM      All-atoms   Total-Side   Main-Chain    Non-polar    All polar\n"
      "REM                ABS   REL    ABS   REL    ABS   REL    ABS   REL    ABS   REL\n",
      atoms.reference ? source_of(*atoms.reference) : "a probe of 1.4 angstrom");
  const ResidueRuns runs = residue_runs(atoms.labels);
  const std::vector<ResidueAreas> all = residue_areas(atoms, runs);
  ResidueAreas total;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const AtomLabel& label = runs.labels[i];
    const auto& [sum, main_chain, polar, max] = all[i];
    const auto [number, icode] = split_number(label.residue_number);
    text.append("RES {} {}{}{} ", in_column(label.residue, 3, "residue name", label),
                in_column(label.chain, 1, "chain name", label),
                in_column(std::string(number), 4, "residue number", label),
                in_column(std::string(icode), 1, "insertion code", label));
    text.append("{}", area_columns_of(sum, max, label));
    for (const double part : {sum - main_chain, main_chain, sum - polar, polar})
      text.append("{}", area_columns_of(part, std::nullopt, label));
    text.append("\n");
    total.all += sum;
    total.main_chain += main_chain;
    total.polar += polar;
  }
  text.append(
      "END  Absolute sums over all chains\nTOTAL {:>15.1f}{:>13.1f}{:>13.1f}{:>13.1f}{:>13.1f}\n",
      total.all, total.all - total.main_chain, total.main_chain, total.all - total.polar,
      total.polar);
}

void append_seq(const MeasuredAtoms& atoms, BufferedText& text) {
  const ResidueRuns runs = residue_runs(atoms.labels);
  const std::vector<ResidueAreas> all = residue_areas(atoms, runs);
  text.append("# Residues\n");
  for (std::size_t i = 0; i < all.size(); ++i) {
    const AtomLabel& label = runs.labels[i];
    const auto [number, icode] = split_number(label.residue_number);
    text.append("SEQ {} {:>4}{:1} {:>3} : {:7.2f}\n", label.chain, number, icode, label.residue,
                all[i].all);
  }
}

void append_res(const MeasuredAtoms& atoms, BufferedText& text) {
  std::map<std::string_view, double> sums;
  for (std::size_t i = 0; i < atoms.labels.size(); ++i)
    sums[atoms.labels[i].residue] += atoms.areas.sas[i];
  text.append("# Residue types\n");
  for (const auto& [residue, sum] : sums) text.append("RES {:>3} : {:10.2f}\n", residue, sum);
}

void append_pdb(const MeasuredAtoms& atoms, BufferedText& text) {
  append_pdb(pdb_heading, atoms, text);
}

void append_pdb(std::string_view heading, const MeasuredAtoms& atoms, BufferedText& text) {
  text.append("{}\n", heading);
  for (std::size_t i = 0; i < atoms.atoms.size(); ++i) {
    const AtomLabel& label = atoms.labels[i];
    const auto& [center, radius] = atoms.atoms[i];
    const auto [number, icode] = split_number(label.residue_number);
    text.append("{:<6}{} {} {} {}{}{}   ", record_of(label),
                in_column(formatted("{}", serial_number(atoms, static_cast<AtomIndex>(i))), 5,
                          "serial number", label),
                name_columns(label), in_column(label.residue, 3, "residue name", label),
                in_column(label.chain, 1, "chain name", label),
                in_column(std::string(number), 4, "residue number", label),
                in_column(std::string(icode), 1, "insertion code", label));
    for (const double coordinate : {center.x, center.y, center.z})
      text.append("{}", in_column(formatted("{:.3f}", coordinate), 8, "coordinate", label));
    text.append("{}{}          {:>2}\n", in_column(formatted("{:.2f}", radius), 6, "radius", label),
                in_column(formatted("{:.2f}", atoms.areas.sas[i]), 6, "area", label),
                upper_case(label.element));
  }
  text.append("END\n");
}

void append_cif(const MeasuredAtoms& atoms, BufferedText& text) {
  text.append("{}\n#\nloop_\n", cif_heading);
  for (const char* name : {"group_PDB",      "id",
                           "type_symbol",    "label_atom_id",
                           "label_alt_id",   "label_comp_id",
                           "label_asym_id",  "label_entity_id",
                           "label_seq_id",   "pdbx_PDB_ins_code",
                           "Cartn_x",        "Cartn_y",
                           "Cartn_z",        "occupancy",
                           "B_iso_or_equiv", "auth_seq_id",
                           "auth_comp_id",   "auth_asym_id",
                           "auth_atom_id",   "pdbx_PDB_model_num"})
    text.append("_atom_site.{}\n", name);
  for (std::size_t i = 0; i < atoms.atoms.size(); ++i) {
    const AtomLabel& label = atoms.labels[i];
    const Vec3 center = atoms.atoms[i].center;
    const auto [number, icode] = split_number(label.residue_number);
    const std::string name = cif_text(label.atom_name, "atom name", label),
                      residue = cif_text(label.residue, "residue name", label),
                      chain = cif_text(label.chain, "chain name", label),
                      auth = atoms.chains.empty()
                                 ? chain
                                 : cif_text(auth_chain(atoms, label), "chain name", label);
    text.append("{} {} {} {} . {} {} . . {} {:.3f} {:.3f} {:.3f} 1.00 {:.6f} {} {} {} {} 1\n",
                record_of(label), serial_number(atoms, static_cast<AtomIndex>(i)),
                label.element.empty() ? "X" : label.element, name, residue, chain,
                icode.empty() ? "?" : cif_text(icode, "insertion code", label), center.x, center.y,
                center.z, atoms.areas.sas[i], cif_text(number, "residue number", label), residue,
                auth, name);
  }
  text.append("#\n");
}

}  // namespace eses::detail
