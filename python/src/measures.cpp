#include "measures.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "interrupts.hpp"
#include "measure_records.hpp"
#include "surface.hpp"
#include "threads.hpp"
#include "warn.hpp"

namespace eses::python {
namespace {

constexpr const char* measure_text =
    R"(measure(self, probe_radius=None, *, ses=True, van_der_waals=False, by_atom=False, derivatives=False, weights=None, threads=0)
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
ses : bool, optional
    Whether to measure the solvent excluded surface. The solvent accessible surface (SAS) alone takes
    a third of the time. Then the Euler number is 0, and other values of the SES are NaN.
van_der_waals : bool, optional
    Whether to measure the van der Waals surface, too.
by_atom : bool, optional
    Whether to divide the areas among the atoms.
derivatives : bool, optional
    Whether to compute the derivatives by the centres, the radii and the probe radius.
weights : array_like, optional
    (N,) weights of the atoms, for weighted sums of their areas and the derivatives of these sums.
threads : int, optional
    Number of threads; 0 for all that the process may use.

Returns
-------
Measures
    Areas and volumes.

Raises
------
ValueError
    If an argument is out of its range, or if derivatives or weighted areas are wanted without the
    SES.)";

constexpr const char* measure_frames_text =
    R"(measure_frames(frames, radii, probe_radius=1.4, *, ses=True, van_der_waals=False, by_atom=False, derivatives=False, weights=None, fill_cavities=False, threads=0)
--

Measure areas and volumes of each frame of a trajectory, several frames at a time.

The result of a frame is that of ``Surface.measure``, to the last bit. Ctrl-C ends the computation.

Parameters
----------
frames : array_like
    (F, N, 3) centres of the atoms, in angstrom. Arrays of float64 and float32 in native byte order
    are read in place, also if they are mapped from a file. Other real types are converted. Another
    iterable of (N, 3) arrays, such as a generator or a trajectory of MDAnalysis, is copied frame by
    frame before the first one is measured. Lists and tuples whose frames share one memory, such as
    ``[ts.positions for ts in u.trajectory]``, are refused, because all frames would be the last one.
    A warning tells what is suspicious in the first frame, such as coordinates in nanometres.
radii : array_like
    (N,) van der Waals radii of the atoms, in angstrom.
probe_radius : float, optional
    Radius of the probe, in angstrom: 0, or 0.01 to 1000.
ses, van_der_waals, by_atom, derivatives : bool, optional
    As for ``Surface.measure``. Areas by atom take 40 bytes for each atom and frame, derivatives 128,
    or 192 with weights.
weights : array_like, optional
    (N,) weights of the atoms, the same for all frames.
fill_cavities : bool or float, optional
    As for ``Surface``: whether the cavities of each frame are filled, or the maximum volume of the
    voids that are, in cubic angstrom.
threads : int, optional
    Number of threads; 0 for all that the process may use.

Returns
-------
FrameMeasures
    Areas and volumes by frame.

Raises
------
ValueError
    If a shape is wrong, if frames share their memory, if an argument is out of its range, or if an atom is not valid. The message
    names the first frame with such an atom by its index.
TypeError
    If an array does not contain real numbers.)";

// The arrays of a result, by frame.
class MeasureArrays {
 public:
  MeasureArrays(py::ssize_t frames, py::ssize_t atoms, const MeasureOptions& options)
      : euler_numbers_(make_array<std::int64_t>(frames)),
        has_ses_(options.ses),
        has_van_der_waals_(options.van_der_waals),
        has_weights_(!options.weights.empty()),
        are_smooth_(make_array<bool>(frames)) {
    for (Doubles& numbers : numbers_) numbers = make_array<double>(frames);
    if (options.by_atom) areas_ = make_areas(frames, atoms);
    if (options.gradients) gradients_.resize(has_weights_ ? gradient_count : gradient_count - 2);
    for (GradientArrays& gradient : gradients_)
      gradient = {Doubles({frames, atoms, py::ssize_t{3}}), Doubles({frames, atoms}),
                  make_array<double>(frames)};
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
  static constexpr std::size_t number_count = 12, area_count = AtomAreasKind::fields.size(),
                               gradient_count = 6;

  std::array<Doubles, area_count> make_areas(py::ssize_t frames, py::ssize_t atoms) const;
  void store_areas(std::size_t frame, const AtomAreas& areas);
  void store_gradients(std::size_t frame, const Gradients& gradients);

  std::array<Doubles, number_count> numbers_;
  py::array_t<std::int64_t> euler_numbers_;
  bool has_ses_, has_van_der_waals_, has_weights_;
  std::optional<std::array<Doubles, area_count>> areas_;
  std::vector<GradientArrays> gradients_;  // without the weighted areas if there are no weights
  py::array_t<bool> are_smooth_;
};

// Without the SES, the arrays of its areas are views of a single NaN.
std::array<MeasureArrays::Doubles, MeasureArrays::area_count> MeasureArrays::make_areas(
    py::ssize_t frames, py::ssize_t atoms) const {
  const Doubles unknown(1);
  *Doubles(unknown).mutable_data(0) = std::numeric_limits<double>::quiet_NaN();
  std::array<Doubles, area_count> areas;
  for (std::size_t k = 0; k < areas.size(); ++k)
    areas[k] = k == 0 || has_ses_ ? Doubles({frames, atoms})
                                  : Doubles({frames, atoms}, {py::ssize_t{0}, py::ssize_t{0}},
                                            unknown.data(), unknown);
  return areas;
}

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
                                                 measures.vdw_volume,
                                                 measures.weighted_ses_area,
                                                 measures.weighted_sas_area};
  // The areas by kind and the curvature belong to the SES.
  constexpr std::array is_of_ses{true,  true, true,  true,  true,  false,
                                 false, true, false, false, false, false};
  for (std::size_t k = 0; k < number_count; ++k)
    *numbers_[k].mutable_data(frame) =
        has_ses_ || !is_of_ses[k] ? numbers[k] : std::numeric_limits<double>::quiet_NaN();
  *euler_numbers_.mutable_data(frame) = measures.euler_number;
  if (areas_) store_areas(frame, measures.by_atom);
  if (!gradients_.empty()) store_gradients(frame, measures.gradients);
}

void MeasureArrays::store_areas(std::size_t frame, const AtomAreas& areas) {
  auto& [sas, ses, convex, saddle, concave] = *areas_;
  std::copy(areas.sas.begin(), areas.sas.end(), sas.mutable_data(frame));
  if (!has_ses_) return;
  std::copy(areas.convex.begin(), areas.convex.end(), convex.mutable_data(frame));
  std::copy(areas.saddle.begin(), areas.saddle.end(), saddle.mutable_data(frame));
  std::copy(areas.concave.begin(), areas.concave.end(), concave.mutable_data(frame));
  double* const sum = ses.mutable_data(frame);
  for (std::size_t i = 0; i < areas.convex.size(); ++i) sum[i] = areas.ses(i);
}

void MeasureArrays::store_gradients(std::size_t frame, const Gradients& gradients) {
  // In the order of GradientsKind.
  const std::array<const Gradient*, gradient_count> sources{
      &gradients.ses_area,   &gradients.ses_volume,        &gradients.sas_area,
      &gradients.sas_volume, &gradients.weighted_ses_area, &gradients.weighted_sas_area};
  for (std::size_t q = 0; q < gradients_.size(); ++q) {
    GradientArrays& target = gradients_[q];
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
    if (std::is_same_v<Kind, FrameMeasuresKind>) return read_only(array);
    if (array.ndim() == 1) return array.attr("item")(0);
    return read_only(array[py::int_(0)]);
  };
  Record<Kind> record;
  record.values.fill(py::none());
  // The last numbers are two of the van der Waals surface, and two weighted areas.
  for (std::size_t k = 0; k < number_count; ++k)
    if (k + 4 < number_count || (k + 2 < number_count ? has_van_der_waals_ : has_weights_))
      record.values[k] = finished(numbers_[k]);
  record.values[number_count] = finished(euler_numbers_);
  if (areas_) {
    Record<AtomAreasKind> areas;
    std::transform(areas_->begin(), areas_->end(), areas.values.begin(), finished);
    record.values[number_count + 1] = py::cast(areas);
  }
  if (!gradients_.empty()) {
    Record<GradientsKind> gradients;
    gradients.values.fill(py::none());
    for (std::size_t q = 0; q < gradients_.size(); ++q) {
      const auto& [centers, radii, probe] = gradients_[q];
      gradients.values[q] =
          py::cast(Record<GradientKind>{{finished(centers), finished(radii), finished(probe)}});
    }
    gradients.values.back() = finished(are_smooth_);
    record.values[number_count + 2] = py::cast(gradients);
  }
  return record;
}

// Raises ValueError if frames in memory are the same object or share their first coordinate, as
// those of a list that is made of the one buffer of a reader.
void require_separate(const py::sequence& frames) {
  std::map<const void*, std::size_t> first;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const py::object frame = frames[i];
    const void* const data = py::isinstance<py::array>(frame)
                                 ? frame.cast<py::array>().data()
                                 : static_cast<const void*>(frame.ptr());
    if (const auto [same, is_new] = first.emplace(data, i); !is_new)
      throw py::value_error("frames " + std::to_string(same->second) + " and " + std::to_string(i) +
                            " share their memory and are equal, as the reader of a trajectory has "
                            "one buffer; copy each frame when it is read, or give the trajectory");
  }
}

// Raises ValueError if the last frame has another shape than the first one.
void require_same_shape(const py::list& frames) {
  const auto first = frames[0].cast<py::array>(),
             last = frames[frames.size() - 1].cast<py::array>();
  if (first.attr("shape").equal(last.attr("shape"))) return;
  throw py::value_error("all frames must have the same atoms: frame " +
                        std::to_string(frames.size() - 1) + " has shape " + shape_text(last) +
                        ", frame 0 has " + shape_text(first));
}

// Returns the frames as one array. A reader of trajectories may yield the same buffer for each
// frame, so the frames of everything but an array are copied one by one.
py::array frames_array(const py::object& frames) {
  constexpr const char* name = "frames";
  const bool is_text = py::isinstance<py::str>(frames) || py::isinstance<py::bytes>(frames);
  if (py::hasattr(frames, "__array__") || !py::isinstance<py::iterable>(frames) || is_text)
    return real_array(frames, name);
  // A reader of MDAnalysis begins anew if it is asked again after its end, which the iterators of
  // pybind11 do.
  if (py::isinstance<py::list>(frames) || py::isinstance<py::tuple>(frames))
    require_separate(frames);
  const py::iterator iterator = py::iter(frames);
  py::list copies;
  while (const auto frame = py::reinterpret_steal<py::object>(PyIter_Next(iterator.ptr()))) {
    copies.append(real_array(frame, "frame " + std::to_string(copies.size())).attr("copy")());
    require_same_shape(copies);
  }
  if (PyErr_Occurred() != nullptr) throw py::error_already_set();
  return real_array(copies, name);
}

// The centres of the atoms by frame, which can be read without the interpreter's lock.
class Frames {
 public:
  // Raises TypeError and ValueError.
  explicit Frames(const py::object& frames) : array_(frames_array(frames)) {
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

// Warns of suspicious atoms in the first frame. Atoms that are not valid are an error later.
void warn_about_first_frame(const Frames& frames, std::span<const double> radii) {
  if (frames.count() == 0) return;
  std::vector<Atom> atoms;
  for (const double radius : radii) atoms.push_back({{}, radius});
  frames.read(0, atoms);
  std::vector<Diagnostic> diagnostics;
  try {
    const py::gil_scoped_release unlocked;
    const Surface surface(std::move(atoms));
    diagnostics.assign(surface.diagnostics().begin(), surface.diagnostics().end());
  } catch (const std::invalid_argument&) {
  }
  warn_about(diagnostics, "frame 0: ");
}

// Returns a weight for each atom, or nothing if there are no weights.
std::vector<double> make_weights(const py::object& weights, std::size_t atoms) {
  if (weights.is_none()) return {};
  return make_atom_values(weights, "weights", atoms);
}

MeasureOptions make_measure_options(std::optional<double> probe_radius, bool ses,
                                    bool van_der_waals, bool by_atom, bool derivatives,
                                    std::span<const double> weights, ThreadCount threads) {
  return {.probe_radius = probe_radius,
          .ses = ses,
          .van_der_waals = van_der_waals,
          .by_atom = by_atom,
          .gradients = derivatives,
          .weights = weights,
          .threads = usable_threads(threads)};
}

Record<MeasuresKind> measure_surface(const ChosenSurface& surface,
                                     std::optional<double> probe_radius, bool ses,
                                     bool van_der_waals, bool by_atom, bool derivatives,
                                     const py::object& weights, ThreadCount threads) {
  require_excluded(surface, "measure",
                   "; its measures have sas_area, and vdw_area with van_der_waals=True");
  const std::vector<double> weight_of = make_weights(weights, surface.atoms().size());
  MeasureOptions options = make_measure_options(probe_radius, ses, van_der_waals, by_atom,
                                                derivatives, weight_of, threads);
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
                                             double probe_radius, bool ses, bool van_der_waals,
                                             bool by_atom, bool derivatives,
                                             const py::object& weights,
                                             const py::object& fill_cavities, ThreadCount threads) {
  const Frames source(frames);
  const SurfaceOptions surface{.max_filled_void = max_filled_void(fill_cavities)};
  const std::vector<double> radius_of =
      make_atom_values(radii, "radii", static_cast<std::size_t>(source.atom_count()));
  const std::vector<double> weight_of = make_weights(weights, radius_of.size());
  MeasureOptions options = make_measure_options(probe_radius, ses, van_der_waals, by_atom,
                                                derivatives, weight_of, threads);
  warn_about_first_frame(source, radius_of);
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
        options, surface);
  }
  return arrays.take<FrameMeasuresKind>();
}

}  // namespace

void bind_measures(py::module_& module, py::class_<ChosenSurface>& surface) {
  bind_measure_records(module);
  surface.def("measure", &measure_surface, measure_text, py::arg("probe_radius") = py::none(),
              py::kw_only(), py::arg("ses") = true, py::arg("van_der_waals") = false,
              py::arg("by_atom") = false, py::arg("derivatives") = false,
              py::arg("weights") = py::none(), py::arg("threads") = 0);
  module.def("measure_frames", &measure_all_frames, measure_frames_text, py::arg("frames"),
             py::arg("radii"), py::arg("probe_radius") = 1.4, py::kw_only(), py::arg("ses") = true,
             py::arg("van_der_waals") = false, py::arg("by_atom") = false,
             py::arg("derivatives") = false, py::arg("weights") = py::none(),
             py::arg("fill_cavities") = false, py::arg("threads") = 0);
}

}  // namespace eses::python
