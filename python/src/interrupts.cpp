#include "interrupts.hpp"

#include <pybind11/pybind11.h>

namespace eses::python {

void Interrupts::check() {
  if (std::this_thread::get_id() != thread_) return;
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  next_ = now + interval;
  const pybind11::gil_scoped_acquire lock;
  if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
}

}  // namespace eses::python
