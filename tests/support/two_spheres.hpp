#pragma once
/// Two spheres in contact, the closed values of their surfaces, and tables with the results.

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "support/sandbox.hpp"

namespace eses::detail::test::two_spheres {

namespace fs = std::filesystem;

inline constexpr double probe = 1.4, radius = 1.7, distance = 3;  // angstrom

using Fields = std::vector<std::string>;

inline Fields split(const std::string& text, char separator) {
  std::istringstream stream(text);
  Fields fields;
  for (std::string field; std::getline(stream, field, separator);) fields.push_back(field);
  if (!text.empty() && text.back() == separator && separator != '\n') fields.emplace_back();
  return fields;
}

/// Rows of a CSV file, without the heading.
inline std::vector<Fields> rows_of(const fs::path& file) {
  std::vector<Fields> rows;
  for (const std::string& line : split(read_file(file), '\n')) rows.push_back(split(line, ','));
  if (!rows.empty()) rows.erase(rows.begin());
  return rows;
}

/// Area of a sphere that a plane at distance `height` from its centre cuts.
inline double cut_sphere_area(double sphere, double height) {
  return 2 * std::numbers::pi * sphere * (sphere + height);
}

/// SAS area of one of two atoms at `distance`.
inline double sas_of_one() { return cut_sphere_area(radius + probe, distance / 2); }

inline double free_sas() { return 4 * std::numbers::pi * (radius + probe) * (radius + probe); }

inline double free_ses() { return 4 * std::numbers::pi * radius * radius; }

// Area of two spheres of radius 1.7 at 3 angstrom, whose saddle has no spindle: the convex zones,
// and the torus patch t p (rho 2a - 2 p sin a) for a full circle.
inline double ses_of_two() {
  const double sas = radius + probe, half = distance / 2;
  const double rho = std::sqrt(sas * sas - half * half), angle = std::asin(half / sas);
  const double convex = 2 * cut_sphere_area(radius, radius * half / sas);
  const double saddle = 4 * std::numbers::pi * probe * (rho * angle - probe * std::sin(angle));
  return convex + saddle;
}

inline std::string pqr_line(int serial, const std::string& residue, const std::string& chain,
                            double x) {
  return fmt::format("ATOM {:6}  CA  {} {}{:4}    {:8.3f}   0.000   0.000  0.00 {:.2f}\n", serial,
                     residue, chain, serial, x, radius);
}

/// A sandbox with two atoms in contact, as xyzr and, with a third atom far away, as PQR.
struct Molecules : Sandbox {
  Molecules() {
    write_file(directory() / "two.xyzr", "0 0 0 1.7\n3 0 0 1.7\n");
    write_file(directory() / "one.xyzr", "1 2 3 2\n");
    write_file(directory() / "dimer.pqr", pqr_line(1, "ALA", "A", 0) +
                                              pqr_line(2, "HEM", "B", distance) +
                                              pqr_line(3, "GLY", "C", 50));
  }
};

inline void check_near(const Molecules& box, const std::string& json, const std::string& key,
                       double expected) {
  check_json(box, json, fmt::format("abs({} - {:.17g}) < 1e-9", key, expected), "True");
}

}  // namespace eses::detail::test::two_spheres
