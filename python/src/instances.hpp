#pragma once
/// Instances that Python makes without calling their constructor, and their states for pickle.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <utility>

namespace eses::python {

namespace py = pybind11;

/// Makes a class safe against instances that were made by `__new__` alone, or whose `__setstate__`
/// has failed: their use raises TypeError. Also makes all pickle protocols call `__getstate__` and
/// `__setstate__`. A class without them raises TypeError when it is pickled.
void protect_instances(py::handle type);

/// A contiguous array of a state.
template <class Value>
using StateArray = py::array_t<Value, py::array::c_style | py::array::forcecast>;

/// Returns the values of a state as a std::tuple or std::array. Raises ValueError if their number
/// or their types are wrong.
template <class Values>
Values unpack_state(const py::tuple& state) {
  try {
    return state.cast<Values>();
  } catch (const py::cast_error&) {
    throw py::value_error("the state is not one that this class has pickled");
  }
}

/// Returns the paths of the files from which an object was read, as a tuple.
py::object files_of(const py::object& object);

/// Remembers the paths of the files from which an object was read.
void remember_files(py::handle object, const py::object& files);

/// Gives an object its value, in an `__init__` or `__setstate__` that is bound with
/// py::detail::is_new_style_constructor, and remembers the files from which it was read, so that
/// `save` does not overwrite them.
template <class Value>
void construct(py::detail::value_and_holder& self, Value value, const py::object& files) {
  self.value_ptr() = new Value(std::move(value));
  if (py::len(files) > 0) remember_files(reinterpret_cast<PyObject*>(self.inst), files);
}

/// Raises ValueError unless an array of a state has the shape (rows,), or (rows, columns) if
/// `columns` is not 0.
void require_shape(const py::array& array, std::size_t rows, std::size_t columns = 0);

}  // namespace eses::python
