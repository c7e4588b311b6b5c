#pragma once
/// Instances that Python makes without calling their constructor, and their states for pickle.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstddef>

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

/// Raises ValueError unless an array of a state has the shape (rows,), or (rows, columns) if
/// `columns` is not 0.
void require_shape(const py::array& array, std::size_t rows, std::size_t columns = 0);

}  // namespace eses::python
