#include "measures.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "instances.hpp"
#include "interrupts.hpp"
#include "threads.hpp"

namespace eses::python {
namespace {

constexpr const char* measure_text =
    R"(measure(self, probe_radius=None, *, van_der_waals=False, by_atom=False, derivatives=False, threads=0)
--

Measure areas and volumes in closed form, without a grid.

Nothing is sampled: the results have rounding errors only. They do not depend on the number of
threads. The method is explained in doc/algorithm.md, after Connolly (J. Appl. Cryst. 16, 548, 1983,
doi:10.1107/S0021889883010985). Other Python threads run meanwhile. Ctrl-C ends the computation.

Parameters
----------
probe_radius : float, optional
    Radius of the probe, in angstrom: 0, or 0.01 to 1000. The default is that of the surface. With 0,
    all surfaces are the van der Waals surface.
van_der_waals : bool, optional
    Whether to measure the van der Waals surface, too. This takes about as long as the rest.
by_atom : bool, optional
    Whether to divide the areas among the atoms.
derivatives : bool, optional
    Whether to compute the derivatives by the centres, the radii and the probe radius.
threads : int, optional
    Number of threads; 0 for all that the process may use.

Returns
-------
Measures
    Areas and volumes.

Raises
------
ValueError
    If an argument is out of its range.)";

constexpr const char* measure_frames_text =
    R"(measure_frames(frames, radii, probe_radius=1.4, *, van_der_waals=False, by_atom=False, derivatives=False, threads=0)
--

Measure areas and volumes of each frame of a trajectory, several frames at a time.

The result of a frame is that of ``Surface.measure``, to the last bit. Ctrl-C ends the computation.

Parameters
----------
frames : array_like
    (F, N, 3) centres of the atoms, in angstrom. Arrays of float64 and float32 in native byte order
    are read in place, also if they are mapped from a file. Other real types are converted.
radii : array_like
    (N,) van der Waals radii of the atoms, in angstrom.
probe_radius : float, optional
    Radius of the probe, in angstrom: 0, or 0.01 to 1000.
van_der_waals, by_atom, derivatives : bool, optional
    As for ``Surface.measure``. Areas by atom take 40 bytes for each atom and frame, derivatives 128.
threads : int, optional
    Number of threads; 0 for all that the process may use.

Returns
-------
FrameMeasures
    Areas and volumes by frame.

Raises
------
ValueError
    If a shape is wrong, if an argument is out of its range, or if an atom is not valid. The message
    names the first frame with such an atom by its index.
TypeError
    If an array does not contain real numbers.)";

constexpr const char* measures_text = R"(Areas and volumes of a surface, from ``Surface.measure``.

Cavities that can contain a probe are outside, and their walls count. All arrays are read-only.)";

constexpr const char* frame_measures_text = R"(Areas and volumes by frame, from ``measure_frames``.

All arrays are read-only. Their first index is that of the frame.)";

constexpr const char* atom_areas_text = R"(Areas of the atoms, in square angstrom.

A point of the surface belongs to the touched atom with the smallest value of
``|x - center|^2 - radius^2``, which is the division of space by the power diagram. All arrays are
read-only.)";

constexpr const char* gradient_text =
    R"(Derivatives of an area or a volume. Lengths are in angstrom.

All arrays are read-only.)";

constexpr const char* gradients_text = R"(Derivatives of areas and volumes.

They are computed in closed form, and not from differences.)";

// The type of an attribute. Attributes of frames have the frame as their first index.
enum class Shape {
  number,     // float
  integer,    // int
  flag,       // bool
  optional,   // float or None
  by_atom,    // (N,) float64
  vectors,    // (N, 3) float64
  areas,      // AtomAreas or None
  gradient,   // Gradient
  gradients,  // Gradients or None
};

struct Field {
  const char* name;
  Shape shape;
  const char* text;
};

// An object of Python with the attributes that its kind lists.
template <class Kind>
struct Record {
  std::array<py::object, Kind::fields.size()> values;
};

struct AtomAreasKind {
  static constexpr const char *name = "AtomAreas", *text = atom_areas_text;
  static constexpr std::array fields{
      Field{"sas", Shape::by_atom, "areas on the solvent accessible surface."},
      Field{"ses", Shape::by_atom, "areas on the solvent excluded surface."},
      Field{"convex", Shape::by_atom, "areas on its convex patches."},
      Field{"saddle", Shape::by_atom, "areas on its saddle patches."},
      Field{"concave", Shape::by_atom, "areas on its concave patches."}};
};

struct GradientKind {
  static constexpr const char *name = "Gradient", *text = gradient_text;
  static constexpr std::array fields{
      Field{"centers", Shape::vectors, "derivatives by the centres of the atoms."},
      Field{"radii", Shape::by_atom, "derivatives by the radii of the atoms."},
      Field{"probe", Shape::number, "derivative by the probe radius."}};
};

struct GradientsKind {
  static constexpr const char *name = "Gradients", *text = gradients_text;
  static constexpr std::array fields{
      Field{"ses_area", Shape::gradient, "of the area of the solvent excluded surface."},
      Field{"ses_volume", Shape::gradient, "of the volume inside it."},
      Field{"sas_area", Shape::gradient, "of the area of the solvent accessible surface."},
      Field{"sas_volume", Shape::gradient, "of the volume inside it."},
      Field{"are_smooth", Shape::flag,
            "whether areas and volumes are smooth: no decision about the patches depended on a "
            "tolerance. Otherwise the derivatives are those of a probe that is smaller by 1e-9 "
            "angstrom, and placements that touch more than three atoms do not contribute."}};
};

constexpr std::array measures_fields{
    Field{"ses_area", Shape::number, "area of the solvent excluded surface, in square angstrom."},
    Field{"ses_volume", Shape::number, "volume inside it, in cubic angstrom."},
    Field{"convex_area", Shape::number, "area of its convex patches, in square angstrom."},
    Field{"saddle_area", Shape::number, "area of its saddle patches, in square angstrom."},
    Field{"concave_area", Shape::number, "area of its concave patches, in square angstrom."},
    Field{"sas_area", Shape::number, "area of the solvent accessible surface, in square angstrom."},
    Field{"sas_volume", Shape::number, "volume inside it, in cubic angstrom."},
    Field{"total_curvature", Shape::number,
          "the Euler number before it is rounded, which shows the rounding errors: the integral of "
          "the curvature divided by 2 pi (theorem of Gauss and Bonnet)."},
    Field{"vdw_area", Shape::optional,
          "area of the van der Waals surface, in square angstrom; None if it was not measured."},
    Field{"vdw_volume", Shape::optional,
          "volume of the van der Waals spheres, in cubic angstrom; None if it was not measured."},
    Field{"euler_number", Shape::integer,
          "Euler number of the solvent accessible surface: the sum over its components of 2 minus "
          "twice the number of handles."},
    Field{"by_atom", Shape::areas, "areas by atom; None if they were not chosen."},
    Field{"gradients", Shape::gradients, "derivatives; None if they were not chosen."}};

struct MeasuresKind {
  static constexpr const char *name = "Measures", *text = measures_text;
  static constexpr auto fields = measures_fields;
};

struct FrameMeasuresKind {
  static constexpr const char *name = "FrameMeasures", *text = frame_measures_text;
  static constexpr auto fields = measures_fields;
};

template <class Kind>
constexpr bool is_of_frame = std::is_same_v<Kind, MeasuresKind>;
template <class Kind>
constexpr bool is_of_frames = std::is_same_v<Kind, FrameMeasuresKind>;

// Returns the type of an attribute for its documentation.
template <class Kind>
std::string type_text(Shape shape) {
  const auto choose = [](const std::string& frame, const std::string& frames) {
    if (is_of_frame<Kind>) return frame + ": ";
    return (is_of_frames<Kind> ? frames : frame + " or " + frames) + ": ";
  };
  switch (shape) {
    case Shape::number:
      return choose("float", "(F,) float64");
    case Shape::integer:
      return choose("int", "(F,) int64");
    case Shape::flag:
      return choose("bool", "(F,) bool");
    case Shape::optional:
      return choose("float or None", "(F,) float64 or None");
    case Shape::by_atom:
      return choose("(N,)", "(F, N) float64");
    case Shape::vectors:
      return choose("(N, 3)", "(F, N, 3) float64");
    case Shape::areas:
      return "AtomAreas or None: ";
    case Shape::gradient:
      return "Gradient: ";
    case Shape::gradients:
      return "Gradients or None: ";
  }
  return "";
}

// The dimensions that all values of a record have in common.
class Dimensions {
 public:
  // Raises ValueError if the values have wrong types, or do not fit the values before.
  template <class Kind>
  void add(const Record<Kind>& record) {
    if (is_of_frame<Kind>) agree(frames_, {});
    for (std::size_t k = 0; k < record.values.size(); ++k)
      add(record.values[k], Kind::fields[k].shape);
    if (is_of_frames<Kind> && frames_->empty()) fail();
  }

 private:
  using Sizes = std::vector<py::ssize_t>;

  [[noreturn]] static void fail() {
    throw py::value_error("the values of the state do not fit together");
  }

  template <class Value>
  static void agree(std::optional<Value>& known, const Value& value) {
    if (known.value_or(value) != value) fail();
    known = value;
  }

  template <class Value>
  static Sizes sizes_of(const py::object& value) {
    if (!py::isinstance<py::array_t<Value>>(value)) fail();
    const auto array = value.cast<py::array>();
    return {array.shape(), array.shape() + array.ndim()};
  }

  static py::ssize_t take_last(Sizes& sizes) {
    if (sizes.empty()) fail();
    const py::ssize_t last = sizes.back();
    sizes.pop_back();
    return last;
  }

  template <class Value>
  void add_number(const py::object& value, bool is_scalar) {
    const Sizes sizes = is_scalar ? Sizes() : sizes_of<Value>(value);
    if (sizes.size() != (is_scalar ? 0 : 1)) fail();
    agree(frames_, sizes);
  }

  void add_by_atom(Sizes sizes) {
    agree(atoms_, take_last(sizes));
    if (sizes.size() > 1) fail();
    agree(frames_, sizes);
  }

  void add(const py::object& value, Shape shape) {
    switch (shape) {
      case Shape::number:
        return add_number<double>(value, PyFloat_Check(value.ptr()) != 0);
      case Shape::integer:
        return add_number<std::int64_t>(value, PyLong_CheckExact(value.ptr()) != 0);
      case Shape::flag:
        return add_number<bool>(value, PyBool_Check(value.ptr()) != 0);
      case Shape::optional:
        if (!value.is_none()) add(value, Shape::number);
        return;
      case Shape::by_atom:
        return add_by_atom(sizes_of<double>(value));
      case Shape::vectors: {
        Sizes sizes = sizes_of<double>(value);
        if (take_last(sizes) != 3) fail();
        return add_by_atom(sizes);
      }
      case Shape::areas:
        if (!value.is_none()) add_record<AtomAreasKind>(value);
        return;
      case Shape::gradient:
        return add_record<GradientKind>(value);
      case Shape::gradients:
        if (!value.is_none()) add_record<GradientsKind>(value);
        return;
    }
  }

  template <class Kind>
  void add_record(const py::object& value) {
    if (!py::isinstance<Record<Kind>>(value)) fail();
    add(value.cast<const Record<Kind>&>());
  }

  std::optional<Sizes> frames_;  // empty for one frame, else the number of frames
  std::optional<py::ssize_t> atoms_;
};

py::object read_only(const py::object& value) {
  if (!py::isinstance<py::array>(value)) return value;
  const py::object view = value.attr("view")();
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

template <class Kind>
Record<Kind> record_of_state(const py::tuple& state) {
  Record<Kind> record;
  if (state.size() != record.values.size())
    throw py::value_error("the state is not one that this class has pickled");
  for (std::size_t k = 0; k < record.values.size(); ++k) record.values[k] = read_only(state[k]);
  Dimensions().add(record);
  return record;
}

template <class Kind>
py::class_<Record<Kind>> bind_record(py::module_& module) {
  py::class_<Record<Kind>> type(module, Kind::name, Kind::text);
  type.attr("__module__") = "eses";
  for (std::size_t k = 0; k < Kind::fields.size(); ++k) {
    const auto& [name, shape, text] = Kind::fields[k];
    type.def_property_readonly(
        name, [k](const Record<Kind>& self) { return self.values[k]; },
        (type_text<Kind>(shape) + text).c_str());
  }
  type.def(py::pickle([](const Record<Kind>& self) { return py::tuple(py::cast(self.values)); },
                      &record_of_state<Kind>));
  protect_instances(type);
  return type;
}

// The arrays of a result, by frame.
class MeasureArrays {
 public:
  MeasureArrays(py::ssize_t frames, py::ssize_t atoms, const MeasureOptions& options)
      : euler_numbers_({frames}), has_van_der_waals_(options.van_der_waals), are_smooth_({frames}) {
    for (Doubles& numbers : numbers_) numbers = Doubles({frames});
    if (options.by_atom)
      for (Doubles& areas : areas_.emplace()) areas = Doubles({frames, atoms});
    if (options.gradients)
      for (GradientArrays& gradient : gradients_.emplace())
        gradient = {Doubles({frames, atoms, py::ssize_t{3}}), Doubles({frames, atoms}),
                    Doubles({frames})};
  }

  // Stores the result of a frame. Several threads may store different frames, without the
  // interpreter's lock.
  void store(std::size_t frame, const eses::Measures& measures);

  // Returns the result of all frames, or of the only one.
  template <class Kind>
  Record<Kind> take() const;

 private:
  using Doubles = py::array_t<double>;
  struct GradientArrays {
    Doubles centers, radii, probe;
  };
  static constexpr std::size_t number_count = 10, area_count = AtomAreasKind::fields.size();

  void store_areas(std::size_t frame, const AtomAreas& areas);
  void store_gradients(std::size_t frame, const Gradients& gradients);

  std::array<Doubles, number_count> numbers_;
  py::array_t<std::int64_t> euler_numbers_;
  bool has_van_der_waals_;
  std::optional<std::array<Doubles, area_count>> areas_;
  std::optional<std::array<GradientArrays, 4>> gradients_;
  py::array_t<bool> are_smooth_;
};

void MeasureArrays::store(std::size_t frame, const eses::Measures& measures) {
  const auto& [convex, saddle, concave] = measures.ses_areas;
  // In the order of `measures_fields`.
  const std::array<double, number_count> numbers{measures.ses_area,
                                                 measures.ses_volume,
                                                 convex,
                                                 saddle,
                                                 concave,
                                                 measures.sas_area,
                                                 measures.sas_volume,
                                                 measures.total_curvature,
                                                 measures.vdw_area,
                                                 measures.vdw_volume};
  for (std::size_t k = 0; k < number_count; ++k) *numbers_[k].mutable_data(frame) = numbers[k];
  *euler_numbers_.mutable_data(frame) = measures.euler_number;
  if (areas_) store_areas(frame, measures.by_atom);
  if (gradients_) store_gradients(frame, measures.gradients);
}

void MeasureArrays::store_areas(std::size_t frame, const AtomAreas& areas) {
  auto& [sas, ses, convex, saddle, concave] = *areas_;
  std::copy(areas.sas.begin(), areas.sas.end(), sas.mutable_data(frame));
  std::copy(areas.convex.begin(), areas.convex.end(), convex.mutable_data(frame));
  std::copy(areas.saddle.begin(), areas.saddle.end(), saddle.mutable_data(frame));
  std::copy(areas.concave.begin(), areas.concave.end(), concave.mutable_data(frame));
  double* const sum = ses.mutable_data(frame);
  for (std::size_t i = 0; i < areas.convex.size(); ++i)
    sum[i] = areas.convex[i] + areas.saddle[i] + areas.concave[i];
}

void MeasureArrays::store_gradients(std::size_t frame, const Gradients& gradients) {
  // In the order of GradientsKind.
  const std::array<const Gradient*, 4> sources{&gradients.ses_area, &gradients.ses_volume,
                                               &gradients.sas_area, &gradients.sas_volume};
  for (std::size_t q = 0; q < sources.size(); ++q) {
    GradientArrays& target = (*gradients_)[q];
    std::memcpy(target.centers.mutable_data(frame), sources[q]->centers.data(),
                sources[q]->centers.size() * sizeof(Vec3));
    std::copy(sources[q]->radii.begin(), sources[q]->radii.end(), target.radii.mutable_data(frame));
    *target.probe.mutable_data(frame) = sources[q]->probe;
  }
  *are_smooth_.mutable_data(frame) = gradients.are_smooth;
}

template <class Kind>
Record<Kind> MeasureArrays::take() const {
  const auto finished = [](const py::array& array) -> py::object {
    if (is_of_frames<Kind>) return read_only(array);
    if (array.ndim() == 1) return array.attr("item")(0);
    return read_only(array[py::int_(0)]);
  };
  Record<Kind> record;
  record.values.fill(py::none());
  for (std::size_t k = 0; k < number_count; ++k)
    if (has_van_der_waals_ || k + 2 < number_count) record.values[k] = finished(numbers_[k]);
  record.values[number_count] = finished(euler_numbers_);
  if (areas_) {
    Record<AtomAreasKind> areas;
    std::transform(areas_->begin(), areas_->end(), areas.values.begin(), finished);
    record.values[number_count + 1] = py::cast(areas);
  }
  if (gradients_) {
    Record<GradientsKind> gradients;
    for (std::size_t q = 0; q < gradients_->size(); ++q) {
      const auto& [centers, radii, probe] = (*gradients_)[q];
      gradients.values[q] =
          py::cast(Record<GradientKind>{{finished(centers), finished(radii), finished(probe)}});
    }
    gradients.values.back() = finished(are_smooth_);
    record.values[number_count + 2] = py::cast(gradients);
  }
  return record;
}

// The centres of the atoms by frame, which can be read without the interpreter's lock.
class Frames {
 public:
  // Raises TypeError and ValueError.
  explicit Frames(const py::object& frames) : array_(real_array(frames, "frames")) {
    if (array_.ndim() != 3 || array_.shape(2) != 3)
      throw py::value_error("frames must have shape (F, N, 3), not " + shape_text(array_));
    is_single_ = py::isinstance<py::array_t<float>>(array_);
    if (!is_single_ && !py::isinstance<py::array_t<double>>(array_)) array_ = as_doubles(array_);
  }

  py::ssize_t count() const { return array_.shape(0); }
  py::ssize_t atom_count() const { return array_.shape(1); }

  // Sets the centres of the atoms of a frame.
  void read(std::size_t frame, std::span<Atom> atoms) const {
    if (is_single_)
      read_as<float>(frame, atoms);
    else
      read_as<double>(frame, atoms);
  }

 private:
  template <class Value>
  void read_as(std::size_t frame, std::span<Atom> atoms) const {
    const py::ssize_t* const strides = array_.strides();
    const auto* next =
        static_cast<const char*>(array_.data()) + static_cast<py::ssize_t>(frame) * strides[0];
    for (Atom& atom : atoms) {
      for (py::ssize_t axis = 0; axis < 3; ++axis) {
        Value value;  // its address need not be aligned
        std::memcpy(&value, next + axis * strides[2], sizeof(Value));
        atom.center[static_cast<std::size_t>(axis)] = value;
      }
      next += strides[1];
    }
  }

  py::array array_;
  bool is_single_;
};

MeasureOptions make_measure_options(std::optional<double> probe_radius, bool van_der_waals,
                                    bool by_atom, bool derivatives, int threads) {
  return {.probe_radius = probe_radius,
          .van_der_waals = van_der_waals,
          .by_atom = by_atom,
          .gradients = derivatives,
          .threads = usable_threads(threads)};
}

Record<MeasuresKind> measure_surface(const Surface& surface, std::optional<double> probe_radius,
                                     bool van_der_waals, bool by_atom, bool derivatives,
                                     int threads) {
  MeasureOptions options =
      make_measure_options(probe_radius, van_der_waals, by_atom, derivatives, threads);
  MeasureArrays arrays(1, static_cast<py::ssize_t>(surface.atoms().size()), options);
  {
    const py::gil_scoped_release unlocked;
    Interrupts interrupts;
    options.check = [&interrupts] { interrupts.check(); };
    arrays.store(0, measure(surface, options));
  }
  return arrays.take<MeasuresKind>();
}

Record<FrameMeasuresKind> measure_all_frames(const py::object& frames, const py::object& radii,
                                             double probe_radius, bool van_der_waals, bool by_atom,
                                             bool derivatives, int threads) {
  const Frames source(frames);
  const std::vector<double> radius_of =
      make_radii(radii, static_cast<std::size_t>(source.atom_count()));
  MeasureOptions options =
      make_measure_options(probe_radius, van_der_waals, by_atom, derivatives, threads);
  MeasureArrays arrays(source.count(), source.atom_count(), options);
  {
    const py::gil_scoped_release unlocked;
    Interrupts interrupts;
    options.check = [&interrupts] { interrupts.check(); };
    measure_frames(
        static_cast<std::size_t>(source.count()), radius_of,
        [&source](std::size_t frame, std::span<Atom> atoms) { source.read(frame, atoms); },
        [&arrays](std::size_t frame, const eses::Measures& measures) {
          arrays.store(frame, measures);
        },
        options);
  }
  return arrays.take<FrameMeasuresKind>();
}

}  // namespace

void bind_measures(py::module_& module, py::class_<Surface>& surface) {
  bind_record<AtomAreasKind>(module);
  bind_record<GradientKind>(module);
  bind_record<GradientsKind>(module);
  bind_record<MeasuresKind>(module).def("__repr__", [](const Record<MeasuresKind>& self) {
    return py::str("<eses.Measures: SES area {:.6g}, SES volume {:.6g}>")
        .format(self.values[0], self.values[1]);
  });
  bind_record<FrameMeasuresKind>(module)
      .def("__len__", [](const Record<FrameMeasuresKind>& self) { return py::len(self.values[0]); })
      .def("__repr__", [](const Record<FrameMeasuresKind>& self) {
        return py::str("<eses.FrameMeasures: {} frames>").format(py::len(self.values[0]));
      });
  surface.def("measure", &measure_surface, measure_text, py::arg("probe_radius") = py::none(),
              py::kw_only(), py::arg("van_der_waals") = false, py::arg("by_atom") = false,
              py::arg("derivatives") = false, py::arg("threads") = 0);
  module.def("measure_frames", &measure_all_frames, measure_frames_text, py::arg("frames"),
             py::arg("radii"), py::arg("probe_radius") = 1.4, py::kw_only(),
             py::arg("van_der_waals") = false, py::arg("by_atom") = false,
             py::arg("derivatives") = false, py::arg("threads") = 0);
}

}  // namespace eses::python
