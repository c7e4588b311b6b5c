#include "support/brute_force.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <sstream>
#include <utility>

#include "support/run.hpp"

namespace eses::detail::test {
namespace {

/// Points nearer than this to the surface may be inside or outside. Angstrom.
constexpr double ambiguous = 1e-7;
/// Maximum distance of a crossing from the surface. Angstrom.
constexpr double on_surface = 1e-6;
/// Maximum gap or overlap between a reported probe and its atoms. Angstrom.
constexpr double contact = 1e-5;
/// Maximum distance of a crossing from its edge; across the edge only the digits of the file count.
/// Angstrom.
constexpr double across_edge = 1e-9;
constexpr double along_edge = 1e-6;
/// Maximum error of a normal's length, and of the direction from a cone.
constexpr double unit_length = 1e-6;
constexpr double in_cone = 1e-5;
/// Maximum relative error of sums that are computed again from the files.
constexpr double same_sum = 1e-6;
/// Lengths, in angstrom, below which a direction or a circle is lost in rounding.
constexpr double no_direction = 1e-12;
/// Pieces of an edge that are shorter than this are judged by their middle. Angstrom.
constexpr double min_interval = 1e-4;
/// Points nearer than this to the crossing are not judged, because the crossing itself is known to
/// `on_surface` only. Angstrom.
constexpr double short_of_crossing = 1e-5;
/// At smaller distances from atoms, the weights of a share are lost in rounding. Angstrom.
constexpr double no_weight = 1e-5;

/// A run as the oracle reads it, and the faults found so far.
struct Check {
  std::span<const Atom> atoms;
  const Parameters& parameters;
  const EsesFiles& files;
  const Summary& summary;
  AccessibleSet set;
  Grid grid;
  std::vector<int> signs;  ///< sign of every grid point in the file; 0 if it is missing
  std::vector<std::string> faults;
};

std::ostream& operator<<(std::ostream& stream, const GridIndex& index) {
  return stream << index[0] << ' ' << index[1] << ' ' << index[2];
}

template <class... Parts>
void report(Check& check, const Parts&... parts) {
  std::ostringstream text;
  text.precision(10);
  (text << ... << parts);
  check.faults.push_back(text.str());
}

bool are_equal(double a, double b) {
  return std::fabs(a - b) <= same_sum * std::max(std::fabs(a), std::fabs(b));
}

/// Makes the grid of ESES, with the same order of double operations.
Grid expected_grid(std::span<const Atom> atoms, const Parameters& parameters) {
  const auto& [spacing, margin] = grid_options(parameters);
  Grid grid;
  grid.spacing = spacing;
  for (std::size_t q = 0; q < 3; ++q) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Atom& atom : atoms) {
      low = std::min(low, atom.center[q] - atom.radius);
      high = std::max(high, atom.center[q] + atom.radius);
    }
    grid.origin[q] = low - margin;
    grid.size[q] = static_cast<int>((high + margin - grid.origin[q]) / spacing) + 1;
  }
  return grid;
}

Vec3 position(const Grid& grid, const GridIndex& index) {
  return {grid.coordinate(0, index[0]), grid.coordinate(1, index[1]), grid.coordinate(2, index[2])};
}

bool in_grid(const Grid& grid, const GridIndex& index) {
  for (std::size_t q = 0; q < 3; ++q)
    if (index[q] < 0 || index[q] >= grid.size[q]) return false;
  return true;
}

std::size_t place_in_file(const Grid& grid, const GridIndex& index) {
  return static_cast<std::size_t>((index[2] * grid.size[1] + index[1]) * grid.size[0] + index[0]);
}

void check_box(Check& check) {
  const double digits = 1e-12;
  for (std::size_t q = 0; q < 3; ++q) {
    const double low = check.grid.origin[q], high = check.grid.upper()[q];
    if (std::fabs(check.files.lower[q] - low) > digits * std::max(1.0, std::fabs(low)) ||
        std::fabs(check.files.upper[q] - high) > digits * std::max(1.0, std::fabs(high)))
      report(check, "box: axis ", q, " should reach from ", low, " to ", high);
  }
  if (check.files.size != check.grid.size) report(check, "box: size should be ", check.grid.size);
  const auto points = static_cast<std::int64_t>(check.files.points.size());
  if (points != check.grid.point_count())
    report(check, "box: ", points, " points, not ", check.grid.point_count());
}

/// Well inside an atom, no probe can be near enough. This saves the search.
bool sign_is_right(const Check& check, Vec3 x, int sign) {
  for (const Atom& atom : check.atoms)
    if (norm(x - atom.center) < atom.radius - ambiguous) return sign == 1;
  const double p = check.parameters.probe_radius;
  const auto nearest = nearest_accessible(check.set, x, p + ambiguous);
  if (!nearest) return sign == 1;
  return sign == -1 || nearest->distance > p - ambiguous;
}

void check_points(Check& check) {
  check.signs.assign(static_cast<std::size_t>(check.grid.point_count()), 0);
  std::size_t place = 0;
  for (const GridPoint& point : check.files.points) {
    if (!in_grid(check.grid, point.index) || place_in_file(check.grid, point.index) != place)
      report(check, "point ", point.index, ": out of place, line ", place + 1);
    else if (!sign_is_right(check, position(check.grid, point.index), point.sign))
      report(check, "point ", point.index, ": should not be ", point.sign);
    check.signs[place++] = point.sign;
  }
}

/// An edge by its lower end, ordered as the file is.
using EdgeKey = std::array<std::int64_t, 4>;

EdgeKey edge_key(GridIndex lower, std::int64_t axis) {
  return {lower[2], lower[1], lower[0], axis};
}

GridIndex lower_end(const EdgeKey& key) { return {key[2], key[1], key[0]}; }

/// Returns nothing if the two points are not the ends of one edge of the grid.
std::optional<EdgeKey> edge_of(const Grid& grid, const Crossing& crossing) {
  if (!in_grid(grid, crossing.inside) || !in_grid(grid, crossing.outside)) return std::nullopt;
  std::optional<EdgeKey> key;
  for (std::size_t q = 0; q < 3; ++q) {
    const std::int64_t step = crossing.outside[q] - crossing.inside[q];
    if (step == 0) continue;
    if (key || std::abs(step) != 1) return std::nullopt;
    key = edge_key(step > 0 ? crossing.inside : crossing.outside, static_cast<std::int64_t>(q));
  }
  return key;
}

/// Returns all edges whose ends differ, in canonical order, from the signs of the file.
std::vector<EdgeKey> expected_edges(const Check& check) {
  std::vector<EdgeKey> edges;
  const GridIndex& n = check.grid.size;
  for (std::int64_t k = 0; k < n[2]; ++k)
    for (std::int64_t j = 0; j < n[1]; ++j)
      for (std::int64_t i = 0; i < n[0]; ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const GridIndex lower{i, j, k};
          GridIndex upper = lower;
          if (++upper[axis] == n[axis]) continue;
          if (check.signs[place_in_file(check.grid, lower)] !=
              check.signs[place_in_file(check.grid, upper)])
            edges.push_back(edge_key(lower, static_cast<std::int64_t>(axis)));
        }
  return edges;
}

void report_difference(Check& check, const std::vector<EdgeKey>& left,
                       const std::vector<EdgeKey>& right, const char* what) {
  std::vector<EdgeKey> difference;
  std::set_difference(left.begin(), left.end(), right.begin(), right.end(),
                      std::back_inserter(difference));
  for (const EdgeKey& key : difference)
    report(check, "edge ", lower_end(key), " along axis ", key[3], ": ", what);
}

void check_edges(Check& check) {
  std::vector<EdgeKey> listed;
  for (const Crossing& crossing : check.files.crossings) {
    const auto key = edge_of(check.grid, crossing);
    if (!key) {
      report(check, "edge ", crossing.inside, " -> ", crossing.outside, ": not an edge");
      continue;
    }
    listed.push_back(*key);
    if (check.signs[place_in_file(check.grid, crossing.inside)] != 1 ||
        check.signs[place_in_file(check.grid, crossing.outside)] != -1)
      report(check, "edge ", crossing.inside, " -> ", crossing.outside, ": not from in to out");
  }
  if (!std::is_sorted(listed.begin(), listed.end())) {
    report(check, "order: edges are not in canonical order");
    std::sort(listed.begin(), listed.end());
  }
  // If an edge is listed twice, one of them is left over here.
  const std::vector<EdgeKey> expected = expected_edges(check);
  report_difference(check, expected, listed, "missing");
  report_difference(check, listed, expected, "listed, but its ends agree or it is there twice");
}

/// Returns the distance of `v` from the cone of `axes`, which are unit vectors. The nearest point
/// of a cone lies on one of its faces. The projection onto the span of a face counts if it lies in
/// the face.
double distance_from_cone(Vec3 v, const std::vector<Vec3>& axes) {
  double best = norm(v);
  const auto offer = [&](Vec3 point) { best = std::min(best, norm(v - point)); };
  for (const Vec3 a : axes) offer(std::max(0.0, dot(v, a)) * a);
  for (std::size_t i = 0; i < axes.size(); ++i)
    for (std::size_t j = i + 1; j < axes.size(); ++j) {
      const double c = dot(axes[i], axes[j]), gram = (1 - c) * (1 + c);
      if (gram < no_direction) continue;
      const double a = dot(v, axes[i]), b = dot(v, axes[j]);
      const double s = (a - c * b) / gram, t = (b - c * a) / gram;
      if (s >= 0 && t >= 0) offer(s * axes[i] + t * axes[j]);
    }
  if (axes.size() < 3) return best;
  const double volume = dot(axes[0], cross(axes[1], axes[2]));
  if (std::fabs(volume) < no_direction) return best;
  const bool within = dot(v, cross(axes[1], axes[2])) / volume >= 0 &&
                      dot(v, cross(axes[2], axes[0])) / volume >= 0 &&
                      dot(v, cross(axes[0], axes[1])) / volume >= 0;
  return within ? 0 : best;
}

double gap(const Atom& atom, Vec3 probe, double probe_radius) {
  return norm(probe - atom.center) - atom.radius - probe_radius;
}

/// Returns the fault of the atoms of a crossing whose probe is at `probe`, or nothing.
///
/// The probe must touch the atoms, and the point must lie in the cone that they span from the
/// probe. If the probe touches more than three atoms, any three of them may be listed.
const char* fault_of_atoms(const Check& check, const Crossing& crossing, Vec3 probe) {
  const double p = check.parameters.probe_radius;
  const auto& listed = crossing.atoms;
  if (listed.empty() || listed.size() > 3) return "not 1 to 3 atoms";
  std::vector<Vec3> axes;
  for (std::size_t a = 0; a < listed.size(); ++a) {
    if (a > 0 && listed[a] <= listed[a - 1]) return "atoms not ascending";
    if (listed[a] < 0 || static_cast<std::size_t>(listed[a]) >= check.atoms.size())
      return "no such atom";
    const Atom& atom = check.atoms[static_cast<std::size_t>(listed[a])];
    if (std::fabs(gap(atom, probe, p)) > contact) return "the probe does not touch its atoms";
    axes.push_back(normalized(atom.center - probe));
  }
  const auto touched = std::count_if(check.atoms.begin(), check.atoms.end(), [&](const Atom& atom) {
    return std::fabs(gap(atom, probe, p)) < contact;
  });
  if (touched <= 3 && distance_from_cone(-crossing.normal, axes) > in_cone)
    return "the patch is not that of its atoms";
  return nullptr;
}

const char* fault_of_place(const Grid& grid, const Crossing& crossing) {
  for (std::size_t q = 0; q < 3; ++q) {
    const double a = grid.coordinate(q, crossing.inside[q]);
    const double b = grid.coordinate(q, crossing.outside[q]);
    const double slack = a == b ? across_edge : along_edge;
    if (crossing.point[q] < std::min(a, b) - slack || crossing.point[q] > std::max(a, b) + slack)
      return "not on its edge";
  }
  return nullptr;
}

const char* fault_of_surface(const Check& check, Vec3 x) {
  const double p = check.parameters.probe_radius;
  const auto nearest = nearest_accessible(check.set, x, p + on_surface);
  if (!nearest) return "not on the surface but inside";
  return nearest->distance < p - on_surface ? "not on the surface but outside" : nullptr;
}

/// Whether all points between `a` and `b` are outside. The distance from the accessible set changes
/// by at most the distance between two points. A piece is therefore outside if its middle is
/// outside by more than half its length. Otherwise both halves are judged.
bool is_outside_between(const Check& check, Vec3 a, Vec3 b) {
  const double half = 0.5 * norm(b - a), limit = check.parameters.probe_radius + ambiguous;
  const Vec3 middle = 0.5 * (a + b);
  const auto nearest = nearest_accessible(check.set, middle, limit);
  if (!nearest) return false;
  if (nearest->distance + half < limit || 2 * half < min_interval) return true;
  return is_outside_between(check, middle, b) && is_outside_between(check, a, middle);
}

/// Checks that all points between the crossing and the outside end are outside.
const char* fault_of_last_interval(const Check& check, const Crossing& crossing) {
  const Vec3 end = position(check.grid, crossing.outside);
  const double length = norm(crossing.point - end);
  if (length <= short_of_crossing) return nullptr;
  const Vec3 beyond = crossing.point + (short_of_crossing / length) * (end - crossing.point);
  return is_outside_between(check, beyond, end) ? nullptr
                                                : "not the last crossing before the outside end";
}

const char* fault_of_crossing(const Check& check, const Crossing& crossing) {
  if (const char* fault = fault_of_place(check.grid, crossing)) return fault;
  if (const char* fault = fault_of_surface(check, crossing.point)) return fault;
  if (std::fabs(norm(crossing.normal) - 1) > unit_length) return "the normal is not a unit vector";
  const Vec3 probe = crossing.point + check.parameters.probe_radius * crossing.normal;
  if (!is_accessible(check.set, probe, contact) ||
      (check.set.is_left_out && check.set.is_left_out(probe)))
    return "no probe stands where the normal leads";
  if (const char* fault = fault_of_atoms(check, crossing, probe)) return fault;
  return fault_of_last_interval(check, crossing);
}

void check_crossings(Check& check) {
  for (const Crossing& crossing : check.files.crossings) {
    if (!edge_of(check.grid, crossing)) continue;  // reported by check_edges
    if (const char* fault = fault_of_crossing(check, crossing))
      report(check, "crossing ", crossing.inside, " -> ", crossing.outside, ": ", fault);
  }
}

/// Returns h^2 times the absolute component of the normal along the edge.
double area_share(const Grid& grid, const Crossing& crossing) {
  double component = 0;
  for (std::size_t q = 0; q < 3; ++q)
    if (crossing.inside[q] != crossing.outside[q]) component = crossing.normal[q];
  return grid.spacing * grid.spacing * std::fabs(component);
}

struct Shares {
  std::vector<double> area;         ///< area of each atom
  std::vector<double> uncertainty;  ///< its possible error, because distances are lost in rounding
};

bool names_atoms(const Check& check, const Crossing& crossing) {
  return !crossing.atoms.empty() &&
         std::all_of(crossing.atoms.begin(), crossing.atoms.end(), [&](std::int64_t atom) {
           return atom >= 0 && static_cast<std::size_t>(atom) < check.atoms.size();
         });
}

void add_shares(const Check& check, const Crossing& crossing, Shares& shares) {
  const double whole = area_share(check.grid, crossing);
  std::vector<double> distances;
  double weights = 0;
  for (const std::int64_t a : crossing.atoms) {
    const Atom& atom = check.atoms[static_cast<std::size_t>(a)];
    distances.push_back(std::max(norm(crossing.point - atom.center) - atom.radius, 1e-15));
    weights += 1 / distances.back();
  }
  const auto tiny =
      std::count_if(distances.begin(), distances.end(), [](double d) { return d < no_weight; });
  for (std::size_t a = 0; a < distances.size(); ++a) {
    const auto atom = static_cast<std::size_t>(crossing.atoms[a]);
    shares.area[atom] += whole / (distances[a] * weights);
    // One tiny distance takes the whole share, whatever its size. Of two, rounding decides which is
    // smaller.
    if (tiny >= 2) shares.uncertainty[atom] += whole;
  }
}

void check_areas(Check& check) {
  const std::size_t n = check.atoms.size();
  Shares shares{std::vector<double>(n), std::vector<double>(n)};
  for (const Crossing& crossing : check.files.crossings)
    if (names_atoms(check, crossing)) add_shares(check, crossing, shares);
  if (check.files.areas.size() != n) {
    report(check, "area: ", check.files.areas.size(), " lines, not ", n);
    return;
  }
  double sum = 0;
  for (std::size_t a = 0; a < n; ++a) {
    const AtomArea& listed = check.files.areas[a];
    sum += listed.area;
    if (listed.atom != static_cast<std::int64_t>(a))
      report(check, "area: line ", a + 1, " is that of atom ", listed.atom);
    const double slack = shares.uncertainty[a] + same_sum * std::max(1.0, shares.area[a]);
    if (!(std::fabs(listed.area - shares.area[a]) <= slack))
      report(check, "area: atom ", a, " has ", listed.area, ", not ", shares.area[a]);
  }
  if (!are_equal(sum, check.summary.area))
    report(check, "area: atoms have ", sum, " together, the summary ", check.summary.area);
}

/// Inside points count for a cell; points of a reported edge, on either side, for half a cell.
double volume_of(const Check& check) {
  std::vector<double> cells(check.signs.size());
  std::transform(check.signs.begin(), check.signs.end(), cells.begin(),
                 [](int sign) { return sign == 1 ? 1.0 : 0.0; });
  for (const Crossing& crossing : check.files.crossings)
    for (const GridIndex& end : {crossing.inside, crossing.outside})
      if (in_grid(check.grid, end)) cells[place_in_file(check.grid, end)] = 0.5;
  double sum = 0;
  for (const double cell : cells) sum += cell;
  return check.grid.spacing * check.grid.spacing * check.grid.spacing * sum;
}

std::int64_t crossings_with(const Check& check, std::size_t atoms) {
  return std::count_if(check.files.crossings.begin(), check.files.crossings.end(),
                       [&](const Crossing& crossing) { return crossing.atoms.size() == atoms; });
}

template <class Number>
void check_sum(Check& check, const char* what, Number summary, Number expected) {
  const bool same = are_equal(static_cast<double>(summary), static_cast<double>(expected));
  if (!same) report(check, "sum: ", what, " ", summary, ", not ", expected);
}

void check_sums(Check& check) {
  double area = 0;
  for (const Crossing& crossing : check.files.crossings) area += area_share(check.grid, crossing);
  check_sum(check, "area", check.summary.area, area);
  check_sum(check, "volume", check.summary.volume, volume_of(check));
  const std::int64_t inside = std::count(check.signs.begin(), check.signs.end(), 1);
  check_sum(check, "inside points", check.summary.inside_points, inside);
  check_sum(check, "convex", check.summary.convex, crossings_with(check, 1));
  check_sum(check, "saddle", check.summary.saddle, crossings_with(check, 2));
  check_sum(check, "concave", check.summary.concave, crossings_with(check, 3));
}

}  // namespace

std::vector<std::string> find_faults(std::span<const Atom> atoms, const Parameters& parameters,
                                     const EsesFiles& files, const Summary& summary,
                                     const std::function<bool(Vec3)>& is_left_out) {
  Check check{atoms,
              parameters,
              files,
              summary,
              make_accessible_set(atoms, parameters.probe_radius),
              expected_grid(atoms, parameters),
              {},
              {}};
  check.set.is_left_out = is_left_out;
  check_box(check);
  if (!check.faults.empty())
    return std::move(check.faults);  // without a grid nothing else can be checked
  check_points(check);
  check_edges(check);
  check_crossings(check);
  check_areas(check);
  check_sums(check);
  return std::move(check.faults);
}

}  // namespace eses::detail::test
