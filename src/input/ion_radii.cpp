#include <array>
#include <string>

#include "input/pdb_elements.hpp"
#include "input/radii_set.hpp"
#include "input/text_fields.hpp"

namespace eses::detail {
namespace {

/// The radius of an ion with six neighbours, in angstrom.
struct IonicRadius {
  std::string_view element;
  double radius;
  /// The residue of an ion with another charge than usual; empty for all others.
  std::string_view residue = {};
};

// Effective ionic radii of R. D. Shannon, Acta Crystallogr. A 32 (1976) 751-767,
// doi:10.1107/S0567739476001551, for six neighbours; iron, manganese and cobalt(II) in high spin,
// cobalt(III), nickel(III) and copper(III) in low spin. The charges are those of the residues in
// the chemical component dictionary of the PDB: FE is iron(III), EU europium(II).
constexpr std::array<IonicRadius, 71> ionic_radii{{
    {"Li", 0.76},         {"Na", 1.02},         {"K", 1.38},         {"Rb", 1.52},
    {"Cs", 1.67},         {"Be", 0.45},         {"Mg", 0.72},        {"Ca", 1.00},
    {"Sr", 1.18},         {"Ba", 1.35},         {"Al", 0.535},       {"Ga", 0.62},
    {"In", 0.80},         {"Tl", 1.50},         {"Pb", 1.19},        {"Sb", 0.76},
    {"Ti", 0.605, "4TI"}, {"V", 0.64},          {"Cr", 0.615},       {"Mn", 0.645, "MN3"},
    {"Mn", 0.83},         {"Fe", 0.78, "FE2"},  {"Fe", 0.645},       {"Co", 0.545, "3CO"},
    {"Co", 0.745},        {"Ni", 0.56, "3NI"},  {"Ni", 0.69},        {"Cu", 0.77, "CU1"},
    {"Cu", 0.54, "CU3"},  {"Cu", 0.73},         {"Zn", 0.74},        {"Y", 0.90},
    {"Zr", 0.72},         {"Mo", 0.65, "4MO"},  {"Mo", 0.59, "6MO"}, {"Ru", 0.68},
    {"Rh", 0.665, "RH3"}, {"Pd", 0.86},         {"Ag", 1.15},        {"Cd", 0.95},
    {"Os", 0.63, "OS4"},  {"Ir", 0.68, "IR3"},  {"Ir", 0.625},       {"Pt", 0.625, "PT4"},
    {"Pt", 0.80},         {"Au", 0.85, "AU3"},  {"Au", 1.37},        {"Hg", 1.02},
    {"La", 1.032},        {"Ce", 1.01},         {"Pr", 0.99},        {"Nd", 0.983},
    {"Sm", 0.958},        {"Eu", 0.947, "EU3"}, {"Eu", 1.17},        {"Gd", 0.938},
    {"Tb", 0.923},        {"Dy", 0.912},        {"Ho", 0.901},       {"Er", 0.890},
    {"Tm", 0.880},        {"Yb", 1.02, "YB2"},  {"Yb", 0.868},       {"Lu", 0.861},
    {"Th", 0.94},         {"Pu", 0.86, "4PU"},  {"Am", 0.975},       {"F", 1.33},
    {"Cl", 1.81},         {"Br", 1.96},         {"I", 2.20},
}};

}  // namespace

std::optional<double> ionic_radius(const AtomIdentity& atom) {
  const std::string residue = upper_case(std::string(atom.residue));
  if (residue != "IOD" && !is_ion({.name_columns = atom.atom,
                                   .residue = atom.residue,
                                   .is_polymer = is_named_polymer(atom.residue)}))
    return std::nullopt;
  for (const IonicRadius& ion : ionic_radii)
    if (ion.element == atom.element && (ion.residue.empty() || ion.residue == residue))
      return ion.radius;
  return std::nullopt;
}

}  // namespace eses::detail
