#pragma once
/// Calls functions that read files.

#include <pybind11/pybind11.h>
#include <pybind11/stl/filesystem.h>

#include <eses/eses.hpp>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>

#include "option_names.hpp"

namespace eses::python {

/// Returns the path of a file. Raises ValueError for a path with a null character, and TypeError
/// for other objects; `others` names those that are accepted besides.
inline std::filesystem::path path_of(const pybind11::object& file, const char* others = "") {
  pybind11::detail::make_caster<std::filesystem::path> caster;
  if (caster.load(file, true))
    return pybind11::detail::cast_op<std::filesystem::path>(std::move(caster));
  if (pybind11::isinstance<pybind11::str>(file) || pybind11::isinstance<pybind11::bytes>(file) ||
      pybind11::hasattr(file, "__fspath__"))
    throw pybind11::value_error("the path is no name of a file: " +
                                pybind11::repr(file).cast<std::string>());
  throw pybind11::type_error(
      "path must be a str, bytes, os.PathLike" + std::string(others) + ", not " +
      pybind11::str(pybind11::type::of(file).attr("__name__")).cast<std::string>());
}

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
    throw std::invalid_argument(with_python_names(error.what()));
  }
}

}  // namespace eses::python
