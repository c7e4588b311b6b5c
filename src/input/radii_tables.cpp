#include "input/radii_tables.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <string>

#include "input/pdb_elements.hpp"
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

/// Van der Waals radii in angstrom; 0 if the source has no value.
struct ElementRadii {
  std::string_view symbol;
  double bondi;
  double freesasa;
};

// Column `bondi`: A. Bondi, J. Phys. Chem. 68 (1964) 441-451, doi:10.1021/j100785a001, as corrected
// and extended to all main-group elements by M. Mantina et al., J. Phys. Chem. A 113 (2009)
// 5806-5812, doi:10.1021/jp8111556 (hydrogen: Bondi's 1.20). Elements of the d and f blocks that
// Bondi does not have are from S. Alvarez, Dalton Trans. 42 (2013) 8617-8636,
// doi:10.1039/c3dt50599e. Compilations that cite Bondi give platinum 1.75 or 1.72; the table has
// 1.75, as FreeSASA does. Column `freesasa`: the radii that FreeSASA 2.1.2 uses for atoms that its
// sets do not name.
constexpr std::array<ElementRadii, 103> radii_by_element{{
    {"H", 1.20, 1.10},  {"He", 1.40, 1.40}, {"Li", 1.81, 1.81}, {"Be", 1.53, 1.53},
    {"B", 1.92, 1.92},  {"C", 1.70, 1.70},  {"N", 1.55, 1.55},  {"O", 1.52, 1.52},
    {"F", 1.47, 1.47},  {"Ne", 1.54, 1.54}, {"Na", 2.27, 2.27}, {"Mg", 1.73, 1.73},
    {"Al", 1.84, 1.84}, {"Si", 2.10, 2.10}, {"P", 1.80, 1.80},  {"S", 1.80, 1.80},
    {"Cl", 1.75, 1.75}, {"Ar", 1.88, 1.88}, {"K", 2.75, 2.75},  {"Ca", 2.31, 2.31},
    {"Sc", 2.58, 2.11}, {"Ti", 2.46, 1.95}, {"V", 2.42, 1.06},  {"Cr", 2.45, 1.13},
    {"Mn", 2.45, 1.19}, {"Fe", 2.44, 1.26}, {"Co", 2.40, 1.13}, {"Ni", 1.63, 1.63},
    {"Cu", 1.40, 1.40}, {"Zn", 1.39, 1.39}, {"Ga", 1.87, 1.87}, {"Ge", 2.11, 2.11},
    {"As", 1.85, 1.85}, {"Se", 1.90, 1.90}, {"Br", 1.83, 1.83}, {"Kr", 2.02, 2.02},
    {"Rb", 3.03, 3.03}, {"Sr", 2.49, 2.49}, {"Y", 2.75, 1.61},  {"Zr", 2.52, 1.42},
    {"Nb", 2.56, 1.33}, {"Mo", 2.45, 1.75}, {"Tc", 2.44, 2.00}, {"Ru", 2.46, 1.20},
    {"Rh", 2.44, 1.22}, {"Pd", 1.63, 1.63}, {"Ag", 1.72, 1.72}, {"Cd", 1.58, 1.58},
    {"In", 1.93, 1.93}, {"Sn", 2.17, 2.17}, {"Sb", 2.06, 2.06}, {"Te", 2.06, 2.06},
    {"I", 1.98, 1.98},  {"Xe", 2.16, 2.16}, {"Cs", 3.43, 3.43}, {"Ba", 2.68, 2.68},
    {"La", 2.98, 1.83}, {"Ce", 2.88, 1.86}, {"Pr", 2.92, 1.62}, {"Nd", 2.95, 1.79},
    {"Pm", 0.00, 1.76}, {"Sm", 2.90, 1.74}, {"Eu", 2.87, 1.96}, {"Gd", 2.83, 1.69},
    {"Tb", 2.79, 1.66}, {"Dy", 2.87, 1.63}, {"Ho", 2.81, 1.61}, {"Er", 2.83, 1.59},
    {"Tm", 2.79, 1.57}, {"Yb", 2.80, 1.54}, {"Lu", 2.74, 1.53}, {"Hf", 2.63, 1.40},
    {"Ta", 2.53, 1.22}, {"W", 2.57, 1.26},  {"Re", 2.49, 1.30}, {"Os", 2.48, 1.58},
    {"Ir", 2.41, 1.22}, {"Pt", 1.75, 1.75}, {"Au", 1.66, 1.66}, {"Hg", 1.55, 1.55},
    {"Tl", 1.96, 1.96}, {"Pb", 2.02, 2.02}, {"Bi", 2.07, 2.07}, {"Po", 1.97, 1.97},
    {"At", 2.02, 2.02}, {"Rn", 2.20, 2.20}, {"Fr", 3.48, 3.48}, {"Ra", 2.83, 2.83},
    {"Ac", 2.80, 2.12}, {"Th", 2.93, 1.84}, {"Pa", 2.88, 1.60}, {"U", 1.86, 1.86},
    {"Np", 2.82, 1.71}, {"Pu", 2.81, 1.67}, {"Am", 2.83, 1.66}, {"Cm", 3.05, 1.65},
    {"Bk", 3.40, 1.64}, {"Cf", 3.05, 1.63}, {"Es", 2.70, 1.62}, {"Fm", 0.00, 1.61},
    {"Md", 0.00, 1.60}, {"No", 0.00, 1.59}, {"Lr", 0.00, 1.58},
}};

std::optional<double> radius_in(double ElementRadii::*column, std::string_view symbol) {
  if (symbol == "D") symbol = "H";
  for (const ElementRadii& element : radii_by_element)
    if (element.symbol == symbol && element.*column > 0) return element.*column;
  return std::nullopt;
}

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

std::optional<double> bondi_radius(std::string_view element) {
  return radius_in(&ElementRadii::bondi, element);
}

std::optional<double> freesasa_element_radius(std::string_view element) {
  return radius_in(&ElementRadii::freesasa, element);
}

std::optional<double> ionic_radius(std::string_view residue, std::string_view atom,
                                   std::string_view element) {
  const std::string name = upper_case(std::string(residue));
  if (name != "IOD" && !is_ion({atom, residue, is_named_polymer(residue)})) return std::nullopt;
  for (const IonicRadius& ion : ionic_radii)
    if (ion.element == element && (ion.residue.empty() || ion.residue == name)) return ion.radius;
  return std::nullopt;
}

}  // namespace eses::detail
