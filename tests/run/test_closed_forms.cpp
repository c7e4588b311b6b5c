/// Tests of surfaces whose area and volume are known in closed form, or whose shape is simple.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "catch.hpp"
#include "support/atom_sets.hpp"
#include "support/brute_force.hpp"
#include "support/eses_files.hpp"
#include "support/run.hpp"
#include "support/temporary_directory.hpp"

namespace eses::detail::test {
namespace {

using std::numbers::pi;

struct Measures {
  double area = 0;
  double volume = 0;
};

Measures operator+(Measures a, Measures b) { return {a.area + b.area, a.volume + b.volume}; }

Measures sphere(double r) { return {4 * pi * r * r, 4 * pi / 3 * r * r * r}; }

/// The cap of a ball of radius r below the plane at height r * cosine over its centre.
Measures ball_below(double r, double cosine) {
  return {2 * pi * r * r * (1 + cosine),
          pi * r * r * r * (2.0 / 3 + cosine - cosine * cosine * cosine / 3)};
}

/// A saddle and the volume between it and its axis, from the plane of the contact circle of radius
/// rho to the place where the probe touches the atom, at the angle phi seen from the probe's
/// centre.
///
/// The meridian is an arc of radius p about a point at distance rho from the axis. Area and volume
/// follow by revolution (Pappus; Connolly, J. Appl. Cryst. 16 (1983), 548-558,
/// doi:10.1107/S0021889883010985):
///   dA = 2 pi (rho - p cos t) p dt,   dV = pi (rho - sqrt(p^2 - z^2))^2 dz,   z = p sin t.
/// If rho < p, the arc crosses the axis in two cusps, and the part between them is left out.
Measures half_saddle(double rho, double p, double phi) {
  const auto from_plane = [&](double t) {
    const double z = p * std::sin(t);
    return Measures{2 * pi * p * (rho * t - z), pi * ((rho * rho + p * p) * z - z * z * z / 3 -
                                                      rho * (z * p * std::cos(t) + p * p * t))};
  };
  const double cusp = rho < p ? std::acos(rho / p) : 0;
  const Measures whole = from_plane(phi), missing = from_plane(cusp);
  return {whole.area - missing.area, whole.volume - missing.volume};
}

/// Two atoms, neither inside the other, whose SAS spheres meet. `along` is the signed distance of
/// the plane of the contact circle from the first centre. If it is negative, the saddle of the
/// smaller atom begins beyond the plane.
Measures two_spheres(double r1, double r2, double distance, double p) {
  const double R1 = r1 + p, R2 = r2 + p;
  const double along = (distance * distance + R1 * R1 - R2 * R2) / (2 * distance);
  const double rho = std::sqrt(R1 * R1 - along * along);
  const double cosine1 = along / R1, cosine2 = (distance - along) / R2;
  return ball_below(r1, cosine1) + ball_below(r2, cosine2) +
         half_saddle(rho, p, std::asin(cosine1)) + half_saddle(rho, p, std::asin(cosine2));
}

/// Three equal atoms at the corners of an equilateral triangle. Two probes, one on each side, touch
/// all of them. The probes do not overlap, and the saddles have no cusps.
///
/// The solid angle of an atom's exposed SAS face follows from the Gauss-Bonnet theorem,
///   omega = 2 psi cos(theta) + 2 delta.
/// Here psi is the accessible angle of a contact circle, theta the angle that it subtends at the
/// atom, and delta the angle of the face at a vertex. The solid angle of a concave triangle is its
/// angular excess. The SES is an inner parallel surface of the SAS, so that
///   V_SES = V_SAS - integral over t from 0 to p of the area of the surface at depth t.
/// V_SAS follows from the divergence theorem: each face, with the flat segments between its arcs
/// and their chords, makes a closed surface.
Measures three_spheres(double r, double side, double p) {
  const double R = r + p, half = side / 2;
  const double rho = std::sqrt(R * R - half * half);
  const double height = std::sqrt(R * R - side * side / 3);
  REQUIRE(rho > p);
  REQUIRE(height > p);

  const double psi = 2 * pi - 2 * std::acos(side / (2 * std::numbers::sqrt3 * rho));
  const double sine_phi = half / R, phi = std::asin(sine_phi);  // cos(theta) = sin(phi)

  const Vec3 a{0, 0, 0}, b{side, 0, 0}, c{half, half * std::numbers::sqrt3, 0};
  const Vec3 vertex = (1.0 / 3) * (a + b + c) + Vec3{0, 0, height};
  const Vec3 n = normalized(vertex - a);
  const Vec3 leave_b = normalized(cross(b - a, n)), leave_c = normalized(cross(n, c - a));
  const double delta = std::acos(dot(leave_b, leave_c));
  const double face = 2 * psi * sine_phi + 2 * delta;

  const double cosine = 1 - side * side / (2 * R * R);
  const double concave = 3 * std::acos(cosine / (1 + cosine)) - pi;

  const double segment = rho * rho / 2 * (psi - std::sin(psi));
  const double sas_volume = R * R * R * face + side * segment;
  return {3 * r * r * face + 3 * psi * p * (2 * rho * phi - 2 * p * sine_phi) + 2 * p * p * concave,
          sas_volume - face * (R * R * R - r * r * r) -
              3 * psi * (rho * phi * p * p - 2.0 / 3 * sine_phi * p * p * p) -
              2.0 / 3 * concave * p * p * p};
}

Summary summary_of(const std::vector<Atom>& atoms, const Parameters& parameters) {
  const TemporaryDirectory directory;
  const Outputs nothing{false, false, false, false};
  const RunPlan plan = make_plan(atoms, parameters, nothing);
  return run(atoms, plan.parameters, nothing, directory.path());
}

/// Relative errors. `counted` is the error of the volume that counts inside points.
struct Errors {
  double area = 0;
  double volume = 0;
  double counted = 0;
};

double square_of_error(double found, double exact) {
  const double error = found / exact - 1;
  return error * error;
}

/// Returns the root mean square over a few margins, which shift the grid: one grid may be lucky.
Errors errors_at(double spacing, const std::vector<Atom>& atoms, double p, Measures exact) {
  constexpr std::array margins{0.8, 0.87, 0.93, 1.01};
  Errors mean;
  for (const double margin : margins) {
    Parameters parameters;
    parameters.probe_radius = p;
    grid_options(parameters).spacing = spacing;
    grid_options(parameters).margin = margin;
    const Summary summary = summary_of(atoms, parameters);
    const auto cells = static_cast<double>(summary.inside_points);
    mean.area += square_of_error(summary.area, exact.area) / margins.size();
    mean.volume += square_of_error(summary.volume, exact.volume) / margins.size();
    mean.counted += square_of_error(cells * std::pow(spacing, 3), exact.volume) / margins.size();
  }
  return {std::sqrt(mean.area), std::sqrt(mean.volume), std::sqrt(mean.counted)};
}

std::string describe(const Errors& errors) {
  return "relative errors of the area " + std::to_string(errors.area) + ", of the volume " +
         std::to_string(errors.volume) + ", of the volume by counting " +
         std::to_string(errors.counted);
}

/// ESES's volume counts points near the surface, on either side, for half a cell. Outside a convex
/// body there are more of them than inside. Its error therefore falls as h^2, by a factor of 16
/// from 0.4 to 0.1. The error of the area is almost random and may be small on a coarse grid by
/// chance.
void check_convergence(const std::vector<Atom>& atoms, double p, Measures exact) {
  INFO("exact area " << exact.area << ", volume " << exact.volume);
  const Errors coarse = errors_at(0.4, atoms, p, exact), fine = errors_at(0.1, atoms, p, exact);
  INFO("at 0.4: " << describe(coarse));
  INFO("at 0.1: " << describe(fine));
  CHECK(fine.area < 0.005);
  CHECK(fine.area < std::max(coarse.area, 0.001));
  CHECK(fine.volume < 0.01);
  CHECK(fine.volume < coarse.volume / 8);
  CHECK(fine.counted < 0.01);
  CHECK(fine.counted < coarse.counted);
}

/// The atoms are rotated, so that their symmetries are not those of the grid.
const Vec3 askew{0.36, 0.48, 0.8};

std::vector<Atom> pair_of_atoms(double r1, double r2, double distance) {
  return {{{0.1, 0.2, 0.3}, r1}, {Vec3{0.1, 0.2, 0.3} + distance * askew, r2}};
}

void check_pair(double r1, double r2, double distance, double p) {
  INFO("radii " << r1 << " and " << r2 << " at " << distance << ", probe radius " << p);
  check_convergence(pair_of_atoms(r1, r2, distance), p, two_spheres(r1, r2, distance, p));
}

}  // namespace

TEST_CASE("one sphere has area and volume of the closed form") {
  for (const double r : {1.2, 1.7, 3.1}) {
    INFO("radius " << r);
    check_convergence({{{0.1, -0.2, 0.3}, r}}, 1.4, sphere(r));
  }
}

TEST_CASE("spheres far apart add up") {
  check_convergence(pair_of_atoms(1.7, 1.2, 6), 1.4, sphere(1.7) + sphere(1.2));
}

TEST_CASE("spheres whose SAS spheres just touch add up") {
  check_convergence(pair_of_atoms(1.7, 1.2, 1.7 + 1.2 + 2.8), 1.4, sphere(1.7) + sphere(1.2));
}

TEST_CASE("two spheres with a saddle between them have area and volume of the closed form") {
  SECTION("atoms overlap") { check_pair(1.7, 1.2, 2.0, 1.4); }
  SECTION("atoms touch") { check_pair(1.5, 1.5, 3.0, 1.4); }
  SECTION("atoms apart") { check_pair(1.5, 1.9, 4.2, 1.4); }
  SECTION("small probe") { check_pair(1.5, 1.9, 3.6, 0.5); }
  SECTION("contact circle beyond the small atom's centre") { check_pair(0.8, 2.5, 2.5, 1.4); }
}

TEST_CASE("two spheres with a spindle torus between them have area and volume of the closed form") {
  SECTION("equal") { check_pair(1.5, 1.5, 5.2, 1.4); }
  SECTION("unequal") { check_pair(1.8, 1.0, 5.0, 1.4); }
  SECTION("large probe") { check_pair(1.5, 1.2, 7.0, 3.0); }
}

TEST_CASE("three spheres with concave triangles have area and volume of the closed form") {
  const double r = 1.7, side = 2.5, p = 1.4;
  const Vec3 u = askew, v = any_perpendicular(u);
  const std::vector<Atom> atoms{
      {{0, 0, 0}, r}, {side * u, r}, {side / 2 * u + side / 2 * std::numbers::sqrt3 * v, r}};
  check_convergence(atoms, p, three_spheres(r, side, p));
}

TEST_CASE("atoms inside an atom change nothing") {
  const std::vector<Atom> alone = pair_of_atoms(1.8, 1.4, 2.6);
  std::vector<Atom> more = alone;
  more.push_back({alone[0].center, 1.0});
  more.push_back({alone[0].center + Vec3{0.4, 0.3, -0.2}, 1.1});
  more.push_back({alone[1].center + Vec3{0, 0.5, 0}, 0});
  more.push_back({alone[1].center + Vec3{0.1, 0, 0}, 1.2});

  const Outputs all;
  const Parameters parameters;
  const TemporaryDirectory without, with;
  const Summary one = run(alone, parameters, all, without.path());
  const Summary two = run(more, parameters, all, with.path());
  CHECK(one.area == two.area);
  CHECK(one.volume == two.volume);
  for (const char* file : {"bounding_box.txt", "grid_info.txt", "intersection_info.txt"}) {
    const bool same = read_bytes(without.path() / file) == read_bytes(with.path() / file);
    INFO(file);
    CHECK(same);
  }
}

TEST_CASE("duplicate atoms change neither area nor volume") {
  const std::vector<Atom> alone = pair_of_atoms(1.8, 1.4, 2.6);
  std::vector<Atom> more = alone;
  more.insert(more.end(), alone.begin(), alone.end());
  const Summary one = summary_of(alone, {}), two = summary_of(more, {});
  CHECK(one.inside_points == two.inside_points);
  CHECK(one.edges() == two.edges());
  CHECK(std::fabs(two.area - one.area) < 1e-9 * one.area);
  CHECK(std::fabs(two.volume - one.volume) < 1e-12 * one.volume);
}

namespace {

/// The grid points of a run, by their place in grid_info.txt.
struct Signs {
  GridIndex size{};
  std::vector<int> signs;

  std::size_t place(const GridIndex& index) const {
    return static_cast<std::size_t>((index[2] * size[1] + index[1]) * size[0] + index[0]);
  }
};

Signs signs_of(const EsesFiles& files) {
  Signs result{files.size, {}};
  for (const GridPoint& point : files.points) result.signs.push_back(point.sign);
  return result;
}

/// Returns the grid point nearest to the origin.
GridIndex nearest_to_origin(const EsesFiles& files, double spacing) {
  GridIndex index{};
  for (std::size_t q = 0; q < 3; ++q) index[q] = std::llround(-files.lower[q] / spacing);
  return index;
}

/// Whether `target` can be reached from the grid's first point along edges between outside points.
bool is_open(Signs signs, const GridIndex& target) {
  std::vector<GridIndex> front{GridIndex{0, 0, 0}};
  while (!front.empty()) {
    const GridIndex index = front.back();
    front.pop_back();
    if (index == target) return true;
    for (const std::size_t axis : {0U, 1U, 2U})
      for (const int step : {-1, 1}) {
        GridIndex next = index;
        next[axis] += step;
        if (next[axis] < 0 || next[axis] >= signs.size[axis]) continue;
        int& sign = signs.signs[signs.place(next)];
        if (sign == -1) front.push_back(next);
        sign = 0;
      }
  }
  return false;
}

}  // namespace

TEST_CASE("a closed cavity is outside if it holds a probe, and inside if it does not") {
  Parameters parameters;
  const double r = 1.7, sas = r + parameters.probe_radius;
  for (const double distance : {0.8 * sas, 0.99 * sas, 1.01 * sas, 1.2 * sas}) {
    INFO("distance of the atoms from the centre: " << distance);
    const std::vector<Atom> atoms = make_icosahedron(distance, r);
    const RunResult result = run_and_read(atoms, parameters);
    const Signs signs = signs_of(result.files);
    const GridIndex middle = nearest_to_origin(result.files, grid_options(parameters).spacing);
    CHECK(signs.signs[signs.place(middle)] == (distance > sas ? -1 : 1));
    CHECK_FALSE(is_open(signs, middle));
    CHECK(find_faults(atoms, parameters, result.files, result.summary).empty());
  }
}

TEST_CASE("an atom of radius 0 has no surface") {
  Parameters parameters;
  grid_options(parameters).margin = 0.9;  // keeps grid points off the atom
  const std::vector<Atom> atoms{{{0, 0, 0}, 0}};
  const RunResult result = run_and_read(atoms, parameters);
  CHECK(result.summary.inside_points == 0);
  CHECK(result.summary.edges() == 0);
  CHECK(result.summary.area == 0);
  CHECK(result.summary.volume == 0);
  CHECK(find_faults(atoms, parameters, result.files, result.summary).empty());
}

TEST_CASE("an atom of radius 0 on a grid point makes at most this point inside") {
  Parameters parameters;
  grid_options(parameters).margin = 2 * grid_options(parameters).spacing;
  const std::vector<Atom> atoms{{{0, 0, 0}, 0}};
  const RunResult result = run_and_read(atoms, parameters);
  CHECK(result.summary.inside_points <= 1);
  CHECK(find_faults(atoms, parameters, result.files, result.summary).empty());
}

}  // namespace eses::detail::test
