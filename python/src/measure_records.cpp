#include "measure_records.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "instances.hpp"

namespace eses::python {
namespace {

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
    case Shape::optional_gradient:
      return "Gradient or None: ";
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
      case Shape::optional_gradient:
        if (!value.is_none()) add_record<GradientKind>(value);
        return;
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
  type.attr("__module__") = "eses_blocks";
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

}  // namespace

py::object read_only(const py::object& value) {
  if (!py::isinstance<py::array>(value)) return value;
  const py::object view = value.attr("view")();
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

void bind_measure_records(py::module_& module) {
  bind_record<AtomAreasKind>(module).def("__repr__", [](const Record<AtomAreasKind>& self) {
    return py::str("<eses_blocks.AtomAreas: arrays of shape {}>")
        .format(py::getattr(self.values[0], "shape", py::none()));
  });
  bind_record<GradientKind>(module).def("__repr__", [](const Record<GradientKind>& self) {
    return py::str("<eses_blocks.Gradient: centers of shape {}>")
        .format(py::getattr(self.values[0], "shape", py::none()));
  });
  bind_record<GradientsKind>(module).def("__repr__", [](const Record<GradientsKind>& self) {
    std::string names;
    for (std::size_t k = 0; k < GradientsKind::fields.size(); ++k)
      if (GradientsKind::fields[k].shape != Shape::flag && !self.values[k].is_none())
        names += std::string(names.empty() ? "" : ", ") + GradientsKind::fields[k].name;
    return "<eses_blocks.Gradients: " + names + ">";
  });
  bind_record<MeasuresKind>(module).def("__repr__", [](const Record<MeasuresKind>& self) {
    return py::str("<eses_blocks.Measures: SES area {:.6g}, SES volume {:.6g}>")
        .format(self.values[0], self.values[1]);
  });
  bind_record<FrameMeasuresKind>(module)
      .def("__len__", [](const Record<FrameMeasuresKind>& self) { return py::len(self.values[0]); })
      .def("__repr__", [](const Record<FrameMeasuresKind>& self) {
        const std::size_t count = py::len(self.values[0]);
        return py::str("<eses_blocks.FrameMeasures: {} {}>")
            .format(count, count == 1 ? "frame" : "frames");
      });
}

}  // namespace eses::python
