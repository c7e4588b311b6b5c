#pragma once
/// Calls functions that read files.

#include <pybind11/pybind11.h>

#include <eses/eses.hpp>
#include <stdexcept>
#include <utility>

namespace eses::python {

/// Calls `read` without the interpreter's lock and returns its result. An error in the content of
/// the file becomes a ValueError. Errors of the operating system and of memory stay as they are.
template <class Read>
auto read_file_as_value(Read&& read) {
  const pybind11::gil_scoped_release unlocked;
  try {
    return std::forward<Read>(read)();
  } catch (const FileError&) {
    throw;
  } catch (const MemoryLimitError&) {
    throw;
  } catch (const Error& error) {
    throw std::invalid_argument(error.what());
  }
}

}  // namespace eses::python
