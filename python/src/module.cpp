// The extension module eses_blocks._core. Docstrings begin with the signature in the form from
// which CPython makes __text_signature__.

#include <pybind11/pybind11.h>

#include <eses/eses.hpp>
#include <exception>
#include <stdexcept>
#include <string_view>

#include "argument_errors.hpp"
#include "atoms.hpp"
#include "background.hpp"
#include "blocks.hpp"
#include "crossings.hpp"
#include "grid.hpp"
#include "interfaces.hpp"
#include "result.hpp"
#include "surface.hpp"

namespace py = pybind11;

namespace {

// Returns the message of an exception. Bytes that are not UTF-8, as in the name of a file, become
// surrogates, as Python decodes names of files.
py::object message_of(const std::exception& error) {
  const std::string_view text = error.what();
  return py::reinterpret_steal<py::object>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "surrogateescape"));
}

// Exceptions that pybind11 cannot translate by itself, or whose messages it cannot decode.
void translate(std::exception_ptr thrown) {  // NOLINT: the type is that of pybind11
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const eses::FileError& error) {
    // With the error number Python chooses the class, such as FileNotFoundError.
    PyErr_SetObject(PyExc_OSError, py::make_tuple(error.code().value(), message_of(error)).ptr());
  } catch (const eses::MemoryLimitError& error) {
    PyErr_SetObject(PyExc_MemoryError, message_of(error).ptr());
  } catch (const eses::Error& error) {
    PyErr_SetObject(PyExc_RuntimeError, message_of(error).ptr());
  } catch (const std::invalid_argument& error) {
    PyErr_SetObject(PyExc_ValueError, message_of(error).ptr());
  }
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  py::options options;
  options.disable_function_signatures();
  module.doc() = "Implementation of the package eses_blocks.";
  module.attr("__version__") = eses::version;
  py::register_local_exception_translator(&translate);
  eses::python::bind_atoms(module);
  eses::python::bind_grid(module);
  eses::python::bind_crossings(module);
  eses::python::bind_result(module);
  eses::python::bind_blocks(module);
  eses::python::bind_surface(module);
  eses::python::bind_interfaces(module);
  eses::python::explain_arguments(module);
  py::module_::import("atexit").attr("register")(py::cpp_function(
      &eses::python::join_threads_left_behind, py::call_guard<py::gil_scoped_release>()));
}
