#include "surface/sphere_union.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>
#include <utility>

#include "geometry/circle_arcs.hpp"
#include "geometry/circle_sectors.hpp"
#include "geometry/covered_arcs.hpp"
#include "geometry/disc_masks.hpp"
#include "geometry/pseudo_angle.hpp"
#include "surface/atom_loops.hpp"
#include "surface/crowded_atoms.hpp"
#include "surface/near_origin.hpp"
#include "surface/relevant_caps.hpp"
#include "system/padding.hpp"
#include "system/parallel.hpp"

namespace eses::detail {
namespace {

using std::numbers::pi;

// Bounds within which rounding does not matter. Lengths are in units of the radius of the SAS
// sphere.
constexpr double min_distance = 1e-4;    // of two centres
constexpr double min_separation = 1e-8;  // of the rims of two caps, somewhere on the circle
constexpr double max_gap = 1e-7;         // in the boundary of a face (angstrom)
constexpr double min_factor = 1e-12;     // squared absolute value of a BoundaryFunction
constexpr double angle_error = 1e-7;     // of the solid angle of a face (steradian)

// A unit vector that no symmetry prefers.
constexpr Vec3 reference{0.36921824504210626, 0.5271827474485805, 0.7653471358283072};

// The sums over the arcs of a face, the accessible part of a SAS sphere. The boundary turns
// clockwise about the axes of the caps.
struct Face {
  double max_angle = 0;             // solid angle outside of the largest cap
  double turn = 0;                  // sum over the arcs of angle * (1 - cosine of the cap)
  std::complex<double> factor = 1;  // product over the arcs, see BoundaryFunction
  Vec3 gap;                         // sum of the chords of all arcs (angstrom)
  bool has_boundary = false;
};

// The contributions of an arc to one of its two faces.
struct FaceOfArc {
  AtomIndex atom = 0;
  double turn = 0;
  std::complex<double> factor = 1;
};

// The contributions of an accessible arc.
struct ArcTerm {
  FaceOfArc first, second;
  Vec3 chord;         // from the start to the end (angstrom)
  double volume = 0;  // cubic angstrom
};

// The arcs that are measured from the atoms of a section.
struct alignas(thread_alignment) ArcTerms {
  std::vector<ArcTerm> arcs;
  bool is_certain = true;

  void clear() {
    arcs.clear();
    is_certain = true;
  }
};

// A unit vector in the frame of a circle.
struct Direction {
  double x = 0, y = 0;

  double pseudo_angle() const { return diamond_angle(x, y); }
};

// A contact circle with a frame.
struct UnionCircle {
  SasSphere first, second;
  ContactCircle circle;
  Vec3 e1, e2;  // perpendicular to the axis and to each other

  UnionCircle(const SasSphere& from, const SasSphere& to, const Cap& cap)
      : first(from), second(to), circle(make_contact_circle(from, to, cap)) {
    // Duff et al., J. Comput. Graph. Tech. 6, 1, 2017.
    const Vec3 axis = circle.axis;
    const double sign = std::copysign(1.0, axis.z);
    const double a = -1 / (sign + axis.z), b = axis.x * axis.y * a;
    e1 = {1 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x};
    e2 = {b, sign + axis.y * axis.y * a, -axis.y};
  }

  double distance() const { return circle.first_height + circle.second_height; }
  CircleInFrame on_first() const {
    return {circle.axis, e1, e2, circle.first_height / first.radius, circle.radius / first.radius};
  }
  CircleInFrame on_second() const {
    return {-circle.axis, e1, -e2, circle.second_height / second.radius,
            circle.radius / second.radius};
  }
  FramedCircle framed() const { return {circle.axis, e1, e2, circle.first_height, circle.radius}; }
  Vec3 radial(Direction d) const { return d.x * e1 + d.y * e2; }
  // Relative to the centre of the first sphere.
  Vec3 point(Direction d) const {
    return circle.first_height * circle.axis + circle.radius * radial(d);
  }
};

// The function z of the points of a circle in doc/algorithm.md. The solid angle of a face is
// -turn - 2 arg(product over arcs of z(start) conj(z(end))) modulo 4 pi.
class BoundaryFunction {
 public:
  // The height of the circle is the cosine of the cap's angular radius, its radius the sine.
  explicit BoundaryFunction(const CircleInFrame& circle)
      : constant_(1 + dot(reference, circle.axis)),
        slope_(circle.radius / (1 + circle.height) *
               std::complex(dot(reference, circle.e1), -dot(reference, circle.e2))) {}

  std::complex<double> operator()(std::complex<double> direction) const {
    return constant_ + slope_ * direction;
  }

 private:
  double constant_;
  std::complex<double> slope_;
};

// The data of an open atom that other atoms use. The section is 0 for an atom that is covered or
// has not been classified yet.
struct OpenAtomEntry {
  std::uint32_t section = 0;  // number of its section, counted from 1
  std::uint32_t caps = 0;     // number of its relevant caps
};

// Returns whether the circle of two open atoms is measured from the first one: from the atom of the
// later section, or else from that with fewer caps. It does not depend on the number of threads.
bool is_measured_from(AtomIndex i, AtomIndex j, std::span<const OpenAtomEntry> atoms) {
  const OpenAtomEntry &a = atoms[i], &b = atoms[j];
  if (b.section == 0) return false;
  if (a.section != b.section) return a.section > b.section;
  return std::pair(a.caps, i) < std::pair(b.caps, j);
}

// Measures the arcs on the SAS spheres of atoms, one atom after the other.
class alignas(thread_alignment) ArcFinder {
 public:
  ArcFinder(const SurfaceModel& surface, Vec3 origin) : surface_(surface), origin_(origin) {}

  void find(const AtomSection& section, std::span<const OpenAtomEntry> atoms, ArcTerms& terms) {
    terms.clear();
    terms_ = &terms;
    for (const OpenAtom& open : section.open_atoms) {
      const auto neighbours = std::span(section.neighbours).subspan(open.begin, open.count);
      if (open.count > max_uncrowded) terms.is_certain = false;
      if (!terms.is_certain) return;
      section_ = &section;
      atom_ = &open;
      sphere_ = surface_.sas_sphere(open.atom);
      floats_.assign(section.caps, section.caps.height, open.begin, open.count, sphere_.radius);
      for (std::uint32_t k = 0; k < open.count; ++k)
        if (is_measured_from(open.atom, neighbours[k], atoms)) add_circle(k);
    }
  }

 private:
  Cap cap(std::uint32_t k) const { return section_->caps[atom_->begin + k]; }

  void add_circle(std::uint32_t own) {
    const AtomIndex j = section_->neighbours[atom_->begin + own];
    const UnionCircle circle(sphere_, surface_.sas_sphere(j), cap(own));
    open_sectors_ = find_open_sectors(circle.on_first(), floats_, sectors_);
    if (open_sectors_ == 0 || !find_intervals(circle, own)) return;
    if (circle.distance() < min_distance * circle.first.radius) terms_->is_certain = false;
    if (intervals_.is_whole) {
      if (is_open(circle, {1, 0})) add_arc(j, circle, {1, 0}, {1, 0}, 2 * pi);
      return;
    }
    for (const auto& [low, high, low_cap, high_cap] : intervals_.intervals) {
      const Direction start{covered_.to_x[low_cap], covered_.to_y[low_cap]};
      const Direction end{covered_.from_x[high_cap], covered_.from_y[high_cap]};
      if (is_in_open_sector(start) && is_open(circle, start))
        add_arc(j, circle, start, end, angle_between(start, end, high - low));
    }
  }

  // Finds the parts of the circle that no cap covers, but for caps that reach no open sector.
  // Returns false if there are none.
  bool find_intervals(const UnionCircle& circle, std::uint32_t own) {
    intervals_.clear();
    list_touching(sectors_, atom_->count, open_sectors_, own, touching_);
    find_covered_arcs(circle.framed(), section_->caps, atom_->begin, touching_,
                      min_separation * circle.first.radius, covered_);
    if (!covered_.is_certain) terms_->is_certain = false;
    if (covered_.is_covered) return false;
    for (std::uint32_t k = 0; k < touching_.size(); ++k) {
      if (covered_.squared_chord[k] <= 0) continue;
      intervals_.block(covered_.from[k], covered_.to[k], k);
      if (intervals_.is_empty()) return false;
    }
    return true;
  }

  bool is_in_open_sector(Direction d) const {
    const int sector = static_cast<int>(sectors_per_unit * d.pseudo_angle()) % sector_count;
    return (open_sectors_ >> sector & 1) != 0;
  }
  // Returns whether a point that no relevant cap covers is accessible.
  bool is_open(const UnionCircle& circle, Direction d) const {
    return table_.contains(atom_->discs, circle.point(d));
  }

  // Returns the angle between two directions whose pseudo-angles have this difference.
  static double angle_between(Direction start, Direction end, double pseudo_angle) {
    const double cosine = start.x * end.x + start.y * end.y;
    double sine = start.x * end.y - start.y * end.x;
    if (pseudo_angle < 1) sine = std::fabs(sine);
    if (pseudo_angle > 3) sine = -std::fabs(sine);
    const double angle = std::atan2(sine, cosine);
    return angle < 0 ? angle + 2 * pi : angle;
  }

  void add_arc(AtomIndex j, const UnionCircle& of, Direction start, Direction end, double angle) {
    const ContactCircle& circle = of.circle;
    const Vec3 chord = circle.radius * (of.radial(end) - of.radial(start));
    const Vec3 center = of.first.center - origin_ + circle.first_height * circle.axis;
    const double volume =
        of.distance() / 6 *
        (circle.radius * circle.radius * angle + dot(circle.axis, cross(center, chord)));
    // Seen from the second sphere, the arc runs the other way.
    const std::complex<double> from(start.x, start.y), to(end.x, end.y);
    terms_->arcs.push_back({face_of(atom_->atom, of.on_first(), from, to, angle),
                            face_of(j, of.on_second(), std::conj(to), std::conj(from), angle),
                            chord, volume});
  }

  FaceOfArc face_of(AtomIndex atom, const CircleInFrame& circle, std::complex<double> start,
                    std::complex<double> end, double angle) {
    const BoundaryFunction z(circle);
    const std::complex<double> from = z(start), to = z(end);
    if (!(std::min(std::norm(from), std::norm(to)) > min_factor)) terms_->is_certain = false;
    return {atom, angle * (1 - circle.height), from * std::conj(to)};
  }

  const SurfaceModel& surface_;
  const DiscTable& table_ = disc_table();
  Vec3 origin_;
  ArcTerms* terms_ = nullptr;
  // The atom that is being measured.
  const AtomSection* section_ = nullptr;
  const OpenAtom* atom_ = nullptr;
  SasSphere sphere_;
  FloatCaps floats_;
  // Its circle with another atom.
  CoveredSectors sectors_;
  Sectors open_sectors_ = 0;
  std::vector<std::int64_t> touching_;  // caps that may reach an open sector
  CoveredArcs covered_;                 // by `touching_`
  OpenIntervals intervals_;
};

// Adds up the contributions of all atoms.
class UnionSums {
 public:
  explicit UnionSums(const SurfaceModel& surface)
      : surface_(surface), faces_(surface.atoms.size()) {}

  void add(const AtomSection& section, const ArcTerms& terms) {
    for (const AngleBound& bound : section.bounds) faces_[bound.atom].max_angle = bound.max_angle;
    for (const ArcTerm& arc : terms.arcs) {
      add(arc.first, -arc.chord);
      add(arc.second, arc.chord);
      volume_ += arc.volume;
    }
  }

  // Returns nothing if a face does not fit together.
  std::optional<SphereUnion> finish() const {
    SphereUnion result{std::vector<double>(faces_.size()), 0, volume_};
    for (AtomIndex i = 0; i < faces_.size(); ++i) {
      const std::optional<double> angle = solid_angle(faces_[i]);
      if (!angle) return std::nullopt;
      const double radius = surface_.atoms[i].radius + surface_.probe_radius;
      result.areas[i] = *angle * radius * radius;
      result.area += result.areas[i];
      result.volume += radius / 3 * result.areas[i];
    }
    return result;
  }

 private:
  void add(const FaceOfArc& term, Vec3 chord) {
    Face& face = faces_[term.atom];
    face.has_boundary = true;
    face.turn += term.turn;
    face.factor *= term.factor;
    // The product of many factors must not overflow.
    constexpr double large = 1e100;
    const double size = std::norm(face.factor);
    if (size > large || size < 1 / large) face.factor /= std::sqrt(size);
    face.gap = face.gap + chord;
  }

  static std::optional<double> solid_angle(const Face& face) {
    if (!face.has_boundary) return whole_or_nothing(face);
    if (norm(face.gap) > max_gap) return std::nullopt;
    const double turns = (-face.turn - 2 * std::arg(face.factor)) / (4 * pi);
    double angle = 4 * pi * (turns - std::floor(turns));
    if (angle > face.max_angle + angle_error) angle -= 4 * pi;
    if (angle < -angle_error) return std::nullopt;
    return std::max(0.0, angle);
  }

  // A sphere without arcs is accessible where it has no cap, and covered where it has one.
  static std::optional<double> whole_or_nothing(const Face& face) {
    if (face.max_angle == 4 * pi) return 4 * pi;
    if (face.max_angle > 4 * pi - angle_error) return std::nullopt;
    return 0;
  }

  const SurfaceModel& surface_;
  std::vector<Face> faces_;  // by atom
  double volume_ = 0;
};

constexpr std::size_t atoms_per_section = 512;

// Sections that are measured before their contributions are added.
constexpr std::size_t sections_per_thread = 4;

// Consecutive sections, measured in two steps: the relevant caps of all atoms, then the arcs of
// open atoms. The arcs need to know which atoms are open, also those of earlier sections.
class SectionSweep {
 public:
  SectionSweep(const SurfaceModel& surface, int threads)
      : surface_(surface),
        order_(surface.cells().order()),
        threads_(threads_for_atoms(order_.size(), threads)),
        atoms_(surface.atoms.size()),
        scratch_(static_cast<std::size_t>(threads_)),
        finders_(scratch_.size(), ArcFinder(surface, middle_of(surface.atoms))),
        sections_(threads_ == 1 ? 1 : sections_per_thread * scratch_.size()),
        terms_(sections_.size()) {}

  std::optional<SphereUnion> run(const CheckCallback& check) {
    UnionSums sums(surface_);
    const std::size_t count = (order_.size() + atoms_per_section - 1) / atoms_per_section;
    for (std::size_t begin = 0; begin < count; begin += sections_.size()) {
      if (check) check();
      const std::size_t end = std::min(begin + sections_.size(), count);
      measure(begin, end);
      for (std::size_t k = 0; k < end - begin; ++k) {
        if (!terms_[k].is_certain) return std::nullopt;
        sums.add(sections_[k], terms_[k]);
      }
    }
    return sums.finish();
  }

 private:
  void measure(std::size_t begin, std::size_t end) {
    const auto count = static_cast<std::int64_t>(end - begin);
    parallel_for(count, threads_, [&](std::int64_t k, int thread) {
      classify(begin + static_cast<std::size_t>(k), scratch_[static_cast<std::size_t>(thread)],
               sections_[static_cast<std::size_t>(k)]);
    });
    parallel_for(count, threads_, [&](std::int64_t k, int thread) {
      finders_[static_cast<std::size_t>(thread)].find(sections_[static_cast<std::size_t>(k)],
                                                      atoms_, terms_[static_cast<std::size_t>(k)]);
    });
  }

  void classify(std::size_t number, RelevantCapScratch& scratch, AtomSection& section) {
    const std::size_t first = number * atoms_per_section;
    find_relevant_caps(surface_,
                       order_.subspan(first, std::min(atoms_per_section, order_.size() - first)),
                       scratch, section);
    for (const OpenAtom& open : section.open_atoms)
      atoms_[open.atom] = {static_cast<std::uint32_t>(number + 1), open.count};
  }

  const SurfaceModel& surface_;
  std::span<const AtomIndex> order_;
  int threads_;
  std::vector<OpenAtomEntry> atoms_;         // by atom
  std::vector<RelevantCapScratch> scratch_;  // by thread
  std::vector<ArcFinder> finders_;           // by thread
  std::vector<AtomSection> sections_;
  std::vector<ArcTerms> terms_;  // by section
};

}  // namespace

std::optional<SphereUnion> measure_union(const SurfaceModel& surface, int threads,
                                         const CheckCallback& check) {
  return SectionSweep(surface, threads).run(check);
}

}  // namespace eses::detail
