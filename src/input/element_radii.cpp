#include <array>

#include "input/radii_set.hpp"

namespace eses::detail {
namespace {

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

}  // namespace

std::optional<double> bondi_radius(std::string_view element) {
  return radius_in(&ElementRadii::bondi, element);
}

std::optional<double> freesasa_element_radius(std::string_view element) {
  return radius_in(&ElementRadii::freesasa, element);
}

}  // namespace eses::detail
