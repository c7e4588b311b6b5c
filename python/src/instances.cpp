#include "instances.hpp"

#include <algorithm>

namespace eses::python {
namespace {

// The older protocols 0 and 1 make an instance of a base class, which pybind11 cannot do.
constexpr int min_protocol = 2;

py::object reduce(const py::object& self, int protocol) {
  const py::object base = py::module_::import("builtins").attr("object");
  return base.attr("__reduce_ex__")(self, std::max(protocol, min_protocol));
}

}  // namespace

void protect_instances(py::handle type) {
  // pybind11 would pass memory with undefined content to functions that expect an object. It
  // allocates this memory with the function that the class has for this purpose.
  py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(type.ptr()))->operator_new =
      [](std::size_t) -> void* {
    throw py::type_error("the object is not initialized; call the constructor of its class");
  };
  type.attr("__reduce_ex__") =
      py::cpp_function(&reduce, py::name("__reduce_ex__"), py::is_method(type));
}

py::object files_of(const py::object& object) {
  return py::module_::import("eses_blocks._paths").attr("files_of")(object);
}

void remember_files(py::handle object, const py::object& files) {
  py::module_::import("eses_blocks._paths").attr("remember_files")(object, *files);
}

void require_shape(const py::array& array, std::size_t rows, std::size_t columns) {
  const py::ssize_t dimensions = columns == 0 ? 1 : 2;
  if (array.ndim() != dimensions || array.shape(0) != static_cast<py::ssize_t>(rows) ||
      (columns != 0 && array.shape(1) != static_cast<py::ssize_t>(columns)))
    throw py::value_error("an array of the state has the wrong shape");
}

}  // namespace eses::python
