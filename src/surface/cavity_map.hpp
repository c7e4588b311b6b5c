#pragma once
/// The components to which probe centres belong, and the components that are filled.
///
/// Every point of a cavity has its nearest SAS sphere among those of the atoms with a face on a
/// wall of the cavity. A segment from the face that is nearest among these atoms to a point meets
/// none of their balls, so it cannot leave or enter a cavity. Therefore these atoms alone decide
/// for any point, however far away it is.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "eses/cavities.hpp"
#include "geometry/box.hpp"
#include "surface/atom_tree.hpp"
#include "surface/components.hpp"
#include "surface/point_tree.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

/// The number of a component of the set of accessible probe centres: 0 is the outside, and the
/// others are the numbers of the cavities, in descending order of their voids.
enum class ComponentNumber : std::uint32_t {};
inline constexpr ComponentNumber outside_component{0};

struct ProbePlacement;

/// An atom that touches probes in a cavity.
struct WallAtom {
  /// The direction to a probe that touches the atom where it has no face.
  struct Contact {
    Vec3 direction;
    ComponentNumber component{};
  };

  /// The component of all faces of the atom, if it has no arcs here.
  ComponentNumber component{};
  /// The arcs of an atom with faces in several components, with the components of their faces.
  LabelledArcs<ComponentNumber> divided;
  std::vector<Contact> contacts;

  /// Returns whether the component depends on the direction.
  bool is_divided() const { return has_arcs() || !contacts.empty(); }
  bool has_arcs() const { return !divided.arcs.empty(); }
  /// Returns the component of the face nearest to a direction from the centre of the atom.
  ComponentNumber component_at(Vec3 direction) const;
};

/// The cavities of a molecule.
class CavityMap {
 public:
  /// `number_of` has the number of each component of `components`. `void_volumes` are in the order
  /// of the numbers. The map serves surfaces with and without slack, see SurfaceModel. If the
  /// components are those of a surface without slack, atoms have patches on other surfaces where
  /// they have no face here.
  CavityMap(const SurfaceModel& surface, const Components& components,
            std::span<const ComponentNumber> number_of, std::vector<double> void_volumes,
            const CheckCallback& check);

  /// Fills all cavities whose voids are at most this large (cubic angstrom).
  void fill(double max_void_volume);
  /// Fills all components except one: the other cavities, and the outside unless it is the
  /// component. Throws Error if there is no such component.
  void keep_only(ComponentNumber component);

  /// Returns whether any component is filled.
  bool has_filled() const;
  bool is_filled(ComponentNumber component) const { return is_filled_[as_number(component)] != 0; }
  /// The filled cavities.
  std::vector<FilledCavity> filled() const;

  /// Gives the atoms other indices, those of a molecule with some of the atoms. `index_of` returns
  /// the index of an atom there, or nothing.
  void renumber(const std::function<std::optional<AtomIndex>(AtomIndex)>& index_of);

  /// Moves all atoms by a vector (angstrom). The map then serves surfaces of the moved atoms, whose
  /// patches may differ because their coordinates are rounded.
  void move(Vec3 by);

  /// Returns the atom if it touches probes in a cavity, else null.
  const WallAtom* find(AtomIndex atom) const;
  /// Returns whether the atom has faces in filled components, and in no other one. Null is an atom
  /// with faces outside only.
  bool is_filled(const WallAtom* atom) const;

  /// Returns the component of an arc of a surface with the same probe.
  ComponentNumber component_of(const SurfaceModel& surface, const Arc& arc) const;
  /// Returns the component of a placement of a surface with the same probe.
  ComponentNumber component_of(std::span<const Atom> atoms, const ProbePlacement& placement) const;
  /// Returns the component of a placement by its centre: `outside_component` if no cavity has one
  /// there.
  ComponentNumber component_of_placement(Vec3 center) const;

  /// Returns the component of a probe that touches a point of the surface, after `fill` by its
  /// number among the cavities that are left. The probe touches the atoms `touched`, which are
  /// three if it is at a placement. `atoms` are those of the molecule.
  ComponentNumber number_at(std::span<const Atom> atoms, std::span<const AtomIndex> touched,
                            Vec3 center) const;

  /// Returns whether the box may contain probe centres of filled components.
  bool may_be_filled(const Box& box) const;
  /// Returns whether the box may contain probe centres of other components.
  bool may_be_kept(const Box& box) const;
  /// Boxes around the probe centres of the cavities that are filled while the outside is not, or
  /// the other way round.
  std::span<const Box> boxes_unlike_outside() const { return boxes_unlike_outside_; }

  /// The component of an accessible probe centre.
  struct Location {
    ComponentNumber component{};
    double clearance = 0;  ///< all points that are nearer to this one belong to it, too (angstrom)
  };
  /// Returns the component of a probe centre that is accessible up to rounding. `found` is scratch
  /// memory.
  Location locate(Vec3 center, std::vector<AtomIndex>& found) const;

 private:
  static constexpr std::uint32_t none = 0xffffffff;

  // Placements of the cavities, in the order of x, with a spatial index.
  struct Placements {
    std::vector<Vec3> centers;
    std::vector<ComponentNumber> components;
    PointTree tree;
  };

  // The middles of boxes, with a spatial index.
  struct Middles {
    std::vector<Vec3> middles;
    double max_half_diagonal = 0;
    PointTree tree;
  };

  // SAS balls with a spatial index, which refers to them.
  struct Balls {
    std::vector<Atom> balls;
    AtomTree tree;

    explicit Balls(std::vector<Atom> of) : balls(std::move(of)), tree(balls) {}
  };

  void add_atoms(const SurfaceModel& surface, const Components& components,
                 std::span<const ComponentNumber> number_of);
  void add_placements(const SurfaceModel& surface, const Components& components,
                      std::span<const ComponentNumber> number_of);
  void add_contacts(std::span<const std::pair<AtomIndex, WallAtom::Contact>> contacts);
  void add_surroundings(const SurfaceModel& surface, const Components& components,
                        const CheckCallback& check);
  void index_boxes();
  void choose_boxes();
  Box& box_of(ComponentNumber cavity) { return boxes_[as_number(cavity) - std::size_t{1}]; }
  ComponentNumber component_near(Vec3 center) const;
  // Replaces `found` by the nearest balls. Returns the distance from them (angstrom).
  double find_nearest_balls(Vec3 center, std::vector<AtomIndex>& found) const;
  bool meets_box_unlike_outside(const Box& box) const;

  // Whether the surface with these components has slack, and its patches are those of the surfaces
  // that the map serves.
  bool has_slack_;
  Vec3 offset_;  // of the molecule from the atoms of the map, where all positions here are
  std::vector<double> void_volumes_;               // by cavity
  std::vector<std::uint8_t> is_filled_;            // by component
  std::vector<ComponentNumber> numbers_;           // by component: see number_at
  std::vector<Box> boxes_, boxes_unlike_outside_;  // around probe centres; `boxes_` by cavity
  std::vector<WallAtom> atoms_;
  std::vector<std::pair<AtomIndex, std::uint32_t>> index_;  // indices into `atoms_`, by atom
  std::shared_ptr<const Placements> placements_;
  std::shared_ptr<const Middles> middles_;   // of `boxes_`
  std::shared_ptr<const Balls> balls_;       // of the atoms, and of other atoms that they meet
  std::vector<std::uint32_t> atom_of_ball_;  // index into `atoms_`, or `none`
};

}  // namespace eses::detail
