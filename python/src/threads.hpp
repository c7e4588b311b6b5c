#pragma once
/// Chooses the number of threads of a computation.

#include <pybind11/pybind11.h>
#include <unistd.h>

#include <limits>

namespace eses::python {

/// The process that loaded the module.
inline const pid_t loading_process = getpid();

/// The number of threads of a caller. Whole numbers of Python beyond the range of int become its
/// limits, which are refused as other numbers out of range are.
struct ThreadCount {
  int value = 0;
};

/// Returns the number of threads to use if the caller asks for `threads`. The result is 1 in a
/// process that was forked from the one that loaded the module: the threads of OpenMP do not
/// survive a fork, and GCC's runtime would wait for them. An invalid number is returned unchanged.
inline int usable_threads(int threads) {
  return threads >= 0 && getpid() != loading_process ? 1 : threads;
}

inline int usable_threads(ThreadCount threads) { return usable_threads(threads.value); }

}  // namespace eses::python

namespace pybind11::detail {

template <>
struct type_caster<eses::python::ThreadCount> {
  PYBIND11_TYPE_CASTER(eses::python::ThreadCount, const_name("int"));

  bool load(handle source, bool) {
    if (!source || PyIndex_Check(source.ptr()) == 0) return false;
    const auto number = reinterpret_steal<object>(PyNumber_Index(source.ptr()));
    if (!number) throw error_already_set();
    int overflow = 0;
    const long long wide = PyLong_AsLongLongAndOverflow(number.ptr(), &overflow);
    using Limits = std::numeric_limits<int>;
    if (overflow > 0 || wide > Limits::max())
      value.value = Limits::max();
    else if (overflow < 0 || wide < Limits::min())
      value.value = Limits::min();
    else
      value.value = static_cast<int>(wide);
    return true;
  }

  static handle cast(eses::python::ThreadCount count, return_value_policy, handle) {
    return PyLong_FromLong(count.value);
  }
};

}  // namespace pybind11::detail
