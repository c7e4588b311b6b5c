#pragma once
/// The results of measurements as Python objects: records of numbers, arrays and other records.

#include <pybind11/pybind11.h>

#include <array>

namespace eses::python {

namespace py = pybind11;

/// The type of an attribute. Arrays of several frames have the frame as their first index.
enum class Shape {
  number,             ///< float
  integer,            ///< int
  flag,               ///< bool
  optional,           ///< float or None
  by_atom,            ///< (N,) float64
  vectors,            ///< (N, 3) float64
  areas,              ///< AtomAreas or None
  gradient,           ///< Gradient
  optional_gradient,  ///< Gradient or None
  gradients,          ///< Gradients or None
};

/// An attribute, and its documentation without the type.
struct Field {
  const char* name;
  Shape shape;
  const char* text;
};

/// A Python object with the attributes that its kind lists.
template <class Kind>
struct Record {
  std::array<py::object, Kind::fields.size()> values;
};

/// Areas by atom.
struct AtomAreasKind {
  static constexpr const char* name = "AtomAreas";
  static constexpr const char* text =
      R"(Areas of the atoms, in square angstrom.

A point of the surface belongs to the touched atom with the smallest value of
``|x - center|^2 - radius^2``, which is the division of space by the power diagram. All arrays are
read-only.)";
  static constexpr std::array fields{
      Field{"sas", Shape::by_atom, "areas on the solvent accessible surface."},
      Field{"ses", Shape::by_atom, "areas on the solvent excluded surface."},
      Field{"convex", Shape::by_atom, "areas on convex patches of the SES."},
      Field{"saddle", Shape::by_atom, "areas on saddle patches of the SES."},
      Field{"concave", Shape::by_atom, "areas on concave patches of the SES."}};
};

/// Derivatives of one area or volume.
struct GradientKind {
  static constexpr const char* name = "Gradient";
  static constexpr const char* text =
      R"(Derivatives of an area or a volume. Lengths are in angstrom.

All arrays are read-only.)";
  static constexpr std::array fields{
      Field{"centers", Shape::vectors, "derivatives by the centres of the atoms."},
      Field{"radii", Shape::by_atom, "derivatives by the radii of the atoms."},
      Field{"probe", Shape::number, "derivative by the probe radius."}};
};

/// Derivatives of all areas and volumes.
struct GradientsKind {
  static constexpr const char* name = "Gradients";
  static constexpr const char* text =
      R"(Derivatives of areas and volumes.

They are computed in closed form, and not from differences.)";
  static constexpr std::array fields{
      Field{"ses_area", Shape::gradient, "of the area of the solvent excluded surface."},
      Field{"ses_volume", Shape::gradient, "of the volume inside the solvent excluded surface."},
      Field{"sas_area", Shape::gradient, "of the area of the solvent accessible surface."},
      Field{"sas_volume", Shape::gradient, "of the volume inside the solvent accessible surface."},
      Field{"weighted_ses_area", Shape::optional_gradient,
            "of the weighted sum of SES areas; None without weights."},
      Field{"weighted_sas_area", Shape::optional_gradient,
            "of the weighted sum of SAS areas; None without weights."},
      Field{"are_smooth", Shape::flag,
            "whether areas and volumes are smooth: no decision about the patches depended on a "
            "tolerance, and no two SAS spheres or concave patches just touch. Otherwise the "
            "derivatives are those of a probe that is smaller by 1e-9 angstrom, and, where a probe "
            "touches more than three atoms, those of atoms that grow, each much more than all "
            "later ones."}};
};

/// The attributes of a result.
inline constexpr std::array measures_fields{
    Field{"ses_area", Shape::number, "area of the solvent excluded surface, in square angstrom."},
    Field{"ses_volume", Shape::number,
          "volume inside the solvent excluded surface, in cubic angstrom."},
    Field{"convex_area", Shape::number,
          "area of the convex patches of the SES, in square angstrom."},
    Field{"saddle_area", Shape::number,
          "area of the saddle patches of the SES, in square angstrom."},
    Field{"concave_area", Shape::number,
          "area of the concave patches of the SES, in square angstrom."},
    Field{"sas_area", Shape::number, "area of the solvent accessible surface, in square angstrom."},
    Field{"sas_volume", Shape::number,
          "volume inside the solvent accessible surface, in cubic angstrom."},
    Field{"total_curvature", Shape::number,
          "the Euler number before it is rounded, which shows the rounding errors: the integral of "
          "the curvature divided by 2 pi (theorem of Gauss and Bonnet)."},
    Field{"vdw_area", Shape::optional,
          "area of the van der Waals surface, in square angstrom; None if it was not measured."},
    Field{"vdw_volume", Shape::optional,
          "volume of the van der Waals spheres, in cubic angstrom; None if it was not measured."},
    Field{"weighted_ses_area", Shape::optional,
          "sum of the areas of the atoms on the SES, each times its weight; None without weights."},
    Field{"weighted_sas_area", Shape::optional,
          "sum of the areas of the atoms on the SAS, each times its weight; None without weights."},
    Field{"euler_number", Shape::integer,
          "Euler number of the solvent accessible surface: the sum over its components of 2 minus "
          "twice the number of handles."},
    Field{"by_atom", Shape::areas, "areas by atom; None if they were not chosen."},
    Field{"gradients", Shape::gradients, "derivatives; None if they were not chosen."}};

/// The result of a surface.
struct MeasuresKind {
  static constexpr const char* name = "Measures";
  static constexpr const char* text =
      R"(Areas and volumes of a surface, from ``Surface.measure``.

Cavities that can contain a probe are outside, and their walls count. All arrays are read-only.)";
  static constexpr auto fields = measures_fields;
};

/// The result of all frames.
struct FrameMeasuresKind {
  static constexpr const char* name = "FrameMeasures";
  static constexpr const char* text =
      R"(Areas and volumes by frame, from ``measure_frames``.

All arrays are read-only. Their first index is that of the frame.)";
  static constexpr auto fields = measures_fields;
};

/// Returns a read-only view of an array, or any other value unchanged.
py::object read_only(const py::object& value);

/// Binds all kinds of records.
void bind_measure_records(py::module_& module);

}  // namespace eses::python
