#include <algorithm>
#include <span>

#include "input/radii_set.hpp"
#include "input/text_fields.hpp"

namespace eses::detail {
namespace {

/// Atoms that have the same radius.
struct RadiusGroup {
  double radius;              ///< in angstrom
  std::string_view residues;  ///< residue names, separated by blanks; `*` for all
  /// Atom names, separated by blanks. `X*` stands for all names that begin with X.
  std::string_view atoms;
};

constexpr std::string_view amino_acids =
    "ALA ARG ASN ASP CYS GLN GLU GLY HIS ILE LEU LYS MET PHE PRO SER THR TRP TYR VAL ASX GLX PYL "
    "SEC MSE";
constexpr std::string_view amino_acids_with_cb =
    "ALA ARG ASN ASP CYS GLN GLU HIS ILE LEU LYS MET PHE PRO SER THR TRP TYR VAL ASX GLX PYL SEC "
    "MSE";
constexpr std::string_view nucleotides = "A C G I T U DA DC DG DI DT DU";

// J. Tsai, R. Taylor, C. Chothia, M. Gerstein, "The packing density in proteins: standard radii and
// volumes", J. Mol. Biol. 290 (1999) 253-266, doi:10.1006/jmbi.1999.2829. The radius depends on
// element, number of neighbours and number of hydrogens: C3H0 1.61, C3H1 1.76, C4H1 to C4H3 1.88,
// N3H0 to N4H3 1.64, O1H0 1.42, O2H1 1.46, S2H0 and S2H1 1.77. The types of atoms, and the radii of
// phosphorus (1.80), selenium (1.90) and X in ASX and GLX (1.50), are from FreeSASA 2.1.2,
// which derives the types from the bonds in the chemical component dictionary of the PDB.
constexpr RadiusGroup protor[] = {
    // C3H0: carbon with three neighbours and no hydrogen
    {1.61, amino_acids, "C"},
    {1.61, "ASN ASP HIS PHE TRP TYR ASX", "CG"},
    {1.61, "GLN GLU GLX", "CD"},
    {1.61, "ARG TYR", "CZ"},
    {1.61, "TRP", "CD2 CE2"},
    {1.61, "PYL C G T U DC DG DT DU", "C2"},
    {1.61, nucleotides, "C4"},
    {1.61, "A G I T DA DG DI DT", "C5"},
    {1.61, "A G I DA DG DI", "C6"},
    // C3H1: aromatic CH
    {1.76, "HIS PHE TYR", "CD2 CE1"},
    {1.76, "PHE TRP TYR", "CD1"},
    {1.76, "PHE TYR PYL", "CE2"},
    {1.76, "PHE", "CZ"},
    {1.76, "TRP", "CE3 CZ2 CZ3 CH2"},
    {1.76, "ACE", "C"},
    {1.76, "A I DA DI", "C2"},
    {1.76, "C U DC DU", "C5"},
    {1.76, "C T U DC DT DU", "C6"},
    {1.76, "A G I DA DG DI", "C8"},
    // C4H1, C4H2, C4H3: aliphatic carbon
    {1.88, amino_acids, "CA"},
    {1.88, amino_acids_with_cb, "CB"},
    {1.88, "ARG GLN GLU LEU LYS MET PRO GLX PYL MSE", "CG"},
    {1.88, "ARG LYS PRO PYL", "CD"},
    {1.88, "LYS MET PYL MSE", "CE"},
    {1.88, "ILE VAL", "CG1"},
    {1.88, "ILE THR VAL PYL", "CG2"},
    {1.88, "ILE LEU", "CD1"},
    {1.88, "LEU PYL", "CD2"},
    {1.88, "PYL", "CA2 CB2"},
    {1.88, "ACE", "CH3"},
    {1.88, nucleotides, "C1' C2' C3' C4' C5'"},
    {1.88, "T DT", "C7"},
    // N: nitrogen of any type
    {1.64, amino_acids, "N"},
    {1.64, "NH2", "N"},
    {1.64, "ARG", "NE NH1 NH2"},
    {1.64, "ASN", "ND2"},
    {1.64, "GLN HIS", "NE2"},
    {1.64, "HIS", "ND1"},
    {1.64, "LYS PYL", "NZ"},
    {1.64, "TRP", "NE1"},
    {1.64, "PYL G DG", "N2"},
    {1.64, nucleotides, "N1 N3"},
    {1.64, "C DC", "N4"},
    {1.64, "A DA", "N6"},
    {1.64, "A G I DA DG DI", "N7 N9"},
    // O1H0: oxygen with one neighbour and no hydrogen
    {1.42, amino_acids, "O"},
    {1.42, "ACE", "O"},
    {1.42, "ASN ASP", "OD1"},
    {1.42, "GLN GLU", "OE1"},
    {1.42, nucleotides, "OP1"},
    {1.42, "PYL C T U DC DT DU", "O2"},
    {1.42, "T U DT DU", "O4"},
    {1.42, "G I DG DI", "O6"},
    // O2H0, O2H1, O2H2: oxygen with two neighbours
    {1.46, amino_acids, "OXT"},
    {1.46, "ASP", "OD2"},
    {1.46, "GLU", "OE2"},
    {1.46, "SER", "OG"},
    {1.46, "THR", "OG1"},
    {1.46, "TYR", "OH"},
    {1.46, "HOH", "O"},
    {1.46, nucleotides, "OP2 OP3 O3' O4' O5'"},
    {1.46, "A C G I U", "O2'"},
    // others
    {1.50, "ASX", "XD1 XD2"},
    {1.50, "GLX", "XE1 XE2"},
    {1.77, "CYS", "SG"},
    {1.77, "MET", "SD"},
    {1.80, nucleotides, "P"},
    {1.90, "SEC MSE", "SE"},
};

// Radii of united atoms by C. Chothia, J. Mol. Biol. 105 (1976) 1-12,
// doi:10.1016/0022-2836(76)90191-1, as the program NACCESS of S. J. Hubbard and J. M. Thornton
// (1993) uses them, with its radii of nucleotides. Carbon with three neighbours is 1.76 and with
// four 1.87, nitrogen of amides 1.65 and of amines 1.50, oxygen 1.40, sulfur 1.85; in nucleotides
// carbon is 1.80, nitrogen 1.60 and phosphorus 1.90. The names, selenium, and the residue ANY,
// which stands for all, are those of FreeSASA 2.1.2; selenomethionine has the carbons of
// methionine.
constexpr RadiusGroup naccess[] = {
    {1.87, "ARG GLN GLU LEU LYS MET PRO MSE", "CG"},
    {1.87, "ARG LYS PRO", "CD"},
    {1.87, "LYS MET MSE", "CE"},
    {1.87, "ILE VAL", "CG1"},
    {1.87, "ILE THR VAL", "CG2"},
    {1.87, "ILE LEU", "CD1"},
    {1.87, "LEU", "CD2"},
    {1.76, "ASN ASP HIS PHE TRP TYR", "CG"},
    {1.76, "GLN GLU", "CD"},
    {1.76, "ARG PHE TYR", "CZ"},
    {1.76, "PHE TRP TYR", "CD1"},
    {1.76, "HIS PHE TRP TYR", "CD2"},
    {1.76, "HIS PHE TYR", "CE1"},
    {1.76, "PHE TRP TYR", "CE2"},
    {1.76, "TRP", "CE3 CZ2 CZ3 CH2"},
    {1.65, "ARG", "NE NH1 NH2"},
    {1.65, "ASN", "ND2"},
    {1.65, "GLN HIS", "NE2"},
    {1.65, "HIS", "ND1"},
    {1.65, "TRP", "NE1"},
    {1.50, "LYS", "NZ"},
    {1.40, "ASN ASP", "OD1"},
    {1.40, "ASP", "OD2"},
    {1.40, "GLN GLU", "OE1"},
    {1.40, "GLU", "OE2"},
    {1.40, "SER", "OG"},
    {1.40, "THR", "OG1"},
    {1.40, "TYR", "OH"},
    {1.85, "CYS", "SG"},
    {1.85, "MET", "SD"},
    {1.80, "SEC MSE", "SE"},
    {1.80, nucleotides, "C2 C4 C5 C6"},
    {1.80, "T DT", "C7"},
    {1.80, "A G I DA DG DI", "C8"},
    {1.60, nucleotides, "N1 N3"},
    {1.60, "G DG", "N2"},
    {1.60, "C DC", "N4"},
    {1.60, "A DA", "N6"},
    {1.60, "A G I DA DG DI", "N7 N9"},
    {1.40, "C T U DC DT DU", "O2"},
    {1.40, "T U DT DU", "O4"},
    {1.40, "G I DG DI", "O6"},
    {1.87, "ANY", "CA CB"},
    {1.76, "ANY", "C"},
    {1.65, "ANY", "N"},
    {1.40, "ANY", "O OXT OP1 OP2 OP3 O2' O3' O4' O5'"},
    {1.80, "ANY", "C1' C2' C3' C4' C5'"},
    {1.90, "ANY", "P"},
};

// Radii of united atoms by T. Ooi, M. Oobatake, G. Nemethy, H. A. Scheraga, Proc. Natl. Acad. Sci.
// USA 84 (1987) 3086-3090, doi:10.1073/pnas.84.10.3086: aliphatic carbon 2.00, aromatic 1.75, of
// carbonyl and carboxyl 1.55, nitrogen 1.55, oxygen 1.40, sulfur 2.00. The names, the radii of
// other elements, and the residue ANY, which stands for all, are those of FreeSASA 2.1.2.
constexpr RadiusGroup oons[] = {
    {2.00, "ARG GLN GLU LEU LYS MET GLX MSE PYL", "CG"},
    {2.00, "ARG LYS PYL", "CD"},
    {2.00, "LYS MET MSE PYL", "CE"},
    {2.00, "ARG", "CZ"},
    {2.00, "ILE VAL", "CG1"},
    {2.00, "ILE THR VAL", "CG2"},
    {2.00, "ILE LEU", "CD1"},
    {2.00, "LEU", "CD2"},
    {2.00, "PYL", "CB2"},
    {2.00, "ACE", "CH3"},
    {1.75, "HIS PHE PRO TRP TYR", "CG"},
    {1.75, "PRO", "CB CD"},
    {1.75, "PHE TRP TYR", "CD1"},
    {1.75, "HIS PHE TRP TYR PYL", "CD2"},
    {1.75, "HIS PHE TYR", "CE1"},
    {1.75, "PHE TRP TYR PYL", "CE2"},
    {1.75, "PHE TYR", "CZ"},
    {1.75, "TRP", "CE3 CZ2 CZ3 CH2"},
    {1.75, "PYL", "CA2 CG2"},
    {1.55, "ASN ASP ASX", "CG"},
    {1.55, "GLN GLU GLX", "CD"},
    {1.55, "PYL", "C2"},
    {1.55, "ARG", "NE NH1 NH2"},
    {1.55, "ASN", "ND2"},
    {1.55, "GLN HIS", "NE2"},
    {1.55, "HIS", "ND1"},
    {1.55, "LYS PYL", "NZ"},
    {1.55, "TRP", "NE1"},
    {1.55, "NH2", "NH2"},
    {1.40, "ASN ASP", "OD1"},
    {1.40, "ASP", "OD2"},
    {1.40, "GLN GLU", "OE1"},
    {1.40, "GLU", "OE2"},
    {1.40, "SER", "OG"},
    {1.40, "THR", "OG1"},
    {1.40, "TYR", "OH"},
    {2.00, "CYS", "SG"},
    {2.00, "MET", "SD"},
    {1.50, "ASX", "XD1 XD2 AD1 AD2"},
    {1.50, "GLX", "XE1 XE2 AE1 AE2"},
    {1.90, "SEC CSE MSE", "SE"},
    {2.00, "ANY", "CA CB CM2 C5'"},
    {1.75, "ANY", "C1' C2' C3' C4' C2 C4 C5 C6 C7 C8"},
    {1.55, "ANY", "C N N1 N2 N3 N4 N6 N7 N9"},
    {1.40, "ANY", "O OXT OP1 OP2 OP3 O2 O4 O6 O2' O3' O4' O5'"},
    {1.80, "ANY", "P"},
};

// Radii of united atoms by M. L. Connolly, J. Appl. Crystallogr. 16 (1983) 548-558,
// doi:10.1107/S0021889883010985, as the program pdb_to_xyzr and its table `atmtypenumbers`
// (revision 1.13) of MSMS assign them to names of residues and atoms: M. F. Sanner, A. J. Olson,
// J.-C. Spehner, Biopolymers 38 (1996) 305-320,
// doi:10.1002/(SICI)1097-0282(199603)38:3%3C305::AID-BIP4%3E3.0.CO;2-Y. Carbon without hydrogens is
// 1.74, aromatic CH 1.86, aliphatic carbon 2.00; nitrogen 1.70, NH2 1.80, NH3 2.00, without
// hydrogen 1.54; oxygen 1.40, OH and water 1.60. As in MSMS, CG of leucine has no hydrogen.
// Manganese is 1.24. The table of MSMS has this value, too, but an earlier rule gives 0.
constexpr RadiusGroup msms[] = {
    {1.60, "WAT HOH H2O DOD DIS", "O*"},
    {1.97, "CA", "CA"},
    {1.49, "CD", "CD"},
    // carbon without hydrogens
    {1.74, "*", "C"},
    {1.74, "ASN ASP ASX HIS HIP HIE HID HISN HISL LEU PHE TRP TYR", "CG"},
    {1.74, "GLU GLN GLX", "CD"},
    {1.74, "ARG TYR", "CZ"},
    {1.74, "TRP", "CD2 CE2"},
    {1.74, "HEM",
     "C1A C1B C1C C1D C2A C2B C2C C2D C3A C3B C3C C3D C4A C4B C4C C4D CGA CGB CGC CGD"},
    {1.74, "MPD", "C2"},
    {1.74, "FMN", "C2 C4 C7 C8 C10 C4A C5A C9A"},
    {1.74, "ALK MYR", "C01"},
    // aromatic CH
    {1.86, "HIS HID HIE HIP HISL", "CE1 CD2"},
    {1.86, "PHE TYR", "CD1 CD2 CE1 CE2"},
    {1.86, "PHE", "CZ"},
    {1.86, "TRP", "CD1 CE3 CZ2 CZ3 CH2"},
    {2.00, "HEM", "CAA CAD CBA CBD"},
    {1.86, "HEM", "CHA CHB CHC CHD CAB CAC CBB CBC"},
    {1.86, "FMN", "C6 C9"},
    // nitrogen other than NH
    {1.80, "ARG", "NH1 NH1A NH1B NH2 NH2A NH2B RH1 RH1A RH1B RH2 RH2A RH2B"},
    {1.80, "ASN ASX", "ND2"},
    {1.80, "GLN", "NE2"},
    {2.00, "LYS", "NZ KZ"},
    {1.54, "HIS HIE HISL", "ND1"},
    {1.54, "HID HISL", "NE2 RE2"},
    {1.54, "HEM", "NA NB NC ND"},
    {1.54, "AZI", "N1 N2 N3"},
    {1.54, "FMN", "N3"},
    {1.54, "PC", "N1"},
    // oxygen with hydrogens
    {1.60, "SER", "OG"},
    {1.60, "THR", "OG1"},
    {1.60, "TYR", "OH"},
    {1.60, "HEM", "OH2"},
    {1.60, "MPD", "O7 O8"},
    {1.40, "FMN", "O2 O4"},
    {1.60, "FMN", "O2* O3* O4*"},
    // sulfur, selenium and metals
    {1.85, "CYH", "SG"},
    {2.00, "CSO", "SE SEG"},
    {1.40, "ASN ASX", "AD1 AD2"},
    {1.40, "GLN GLX", "AE1 AE2"},
    {1.70, "HIS HID HIP HISD", "AD1 AD2 AE1 AE2"},
    {1.30, "FS3 FS4", "FE1 FE2 FE3 FE4 FE5 FE6 FE7"},
    {1.30, "FEO", "FE1 FE2"},
    {1.30, "HEM", "FE"},
    {1.40, "*", "CU ZN"},
    {1.24, "*", "FE MN"},
    {1.60, "*", "MG"},
    {1.25, "*", "CO"},
    {2.15, "*", "SE"},
    {1.15, "*", "YB"},
    // all other atoms, by the first letter of the name
    {2.00, "*", "SEG"},
    {1.40, "*", "E*"},
    {1.80, "*", "S*"},
    {2.00, "*", "C*"},
    {1.86, "*", "A*"},
    {1.40, "*", "O*"},
    {1.70, "*", "N* R*"},
    {2.00, "*", "K*"},
    {1.80, "*", "P*"},
    {1.80, "CYS MET", "LP1 LP2"},
};

bool has_match(std::string_view patterns, std::string_view name) {
  if (has_word(patterns, name)) return true;
  if (patterns.find('*') == patterns.npos) return false;
  for (std::string_view pattern = take_first(patterns); !pattern.empty();
       pattern = take_first(patterns))
    if (pattern.back() == '*' && name.starts_with(pattern.substr(0, pattern.size() - 1)))
      return true;
  return false;
}

/// Returns the radius of the first group that contains the atom.
std::optional<double> find_radius(std::span<const RadiusGroup> groups, std::string_view residue,
                                  std::string_view atom) {
  const auto found = std::find_if(groups.begin(), groups.end(), [&](const RadiusGroup& group) {
    return has_match(group.atoms, atom) && has_match(group.residues, residue);
  });
  return found == groups.end() ? std::nullopt : std::optional(found->radius);
}

}  // namespace

std::optional<double> protor_radius(std::string_view residue, std::string_view atom) {
  return find_radius(protor, residue, atom);
}

std::optional<double> naccess_radius(std::string_view residue, std::string_view atom) {
  return find_radius(naccess, residue, atom);
}

std::optional<double> oons_radius(std::string_view residue, std::string_view atom) {
  return find_radius(oons, residue, atom);
}

std::optional<double> msms_radius(std::string_view residue, std::string_view atom) {
  return find_radius(msms, residue, atom);
}

}  // namespace eses::detail
