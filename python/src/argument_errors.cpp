#include "argument_errors.hpp"

#include <string>

namespace py = pybind11;

namespace eses::python {
namespace {

/// The first argument of a call in the second attempt of pybind11, which allows conversions. Until
/// then, the function itself may accept the arguments.
struct LastAttempt {
  py::object first;
};

}  // namespace
}  // namespace eses::python

namespace pybind11::detail {

template <>
struct type_caster<eses::python::LastAttempt> {
  PYBIND11_TYPE_CASTER(eses::python::LastAttempt, const_name("object"));
  bool load(handle source, bool may_convert) {
    value.first = reinterpret_borrow<object>(source);
    return may_convert;
  }
};

}  // namespace pybind11::detail

namespace eses::python {
namespace {

/// Raises TypeError for arguments of a function. `first` is an ellipsis if there is none.
[[noreturn]] void refuse(const py::handle& scope, const std::string& name, const py::object& self,
                         const py::object& first, const py::args& others,
                         const py::kwargs& keywords) {
  py::list arguments;
  if (self) arguments.append(self);
  if (!first.is(py::ellipsis())) arguments.append(first);
  for (const py::handle argument : others) arguments.append(argument);
  py::module_::import("eses_blocks._arguments")
      .attr("refuse")(scope.attr(name.c_str()), py::tuple(arguments), keywords);
  throw py::type_error(name + ": an argument has a wrong type");
}

py::cpp_function overload_of_constructor(const py::handle& type, const py::object& sibling) {
  return {[type](py::detail::value_and_holder& /*self*/, const LastAttempt& attempt,
                 const py::args& others, const py::kwargs& keywords) {
            refuse(type, "__init__", py::none(), attempt.first, others, keywords);
          },
          py::name("__init__"),
          py::is_method(type),
          py::sibling(sibling),
          py::detail::is_new_style_constructor(),
          py::arg("first") = py::ellipsis()};
}

py::cpp_function overload_of_method(const py::handle& type, const std::string& name,
                                    const py::object& sibling) {
  return {[type, name](const py::object& self, const LastAttempt& attempt, const py::args& others,
                       const py::kwargs& keywords) -> py::object {
            refuse(type, name, self, attempt.first, others, keywords);
          },
          py::name(name.c_str()), py::is_method(type), py::sibling(sibling),
          py::arg("first") = py::ellipsis()};
}

py::cpp_function overload_of_function(const py::handle& module, const std::string& name,
                                      const py::object& sibling) {
  return {[module, name](const LastAttempt& attempt, const py::args& others,
                         const py::kwargs& keywords) -> py::object {
            refuse(module, name, {}, attempt.first, others, keywords);
          },
          py::name(name.c_str()), py::scope(module), py::sibling(sibling),
          py::arg("first") = py::ellipsis()};
}

/// Calls `visit` with the name and the object of each function of a module or class.
void for_each_function(const py::handle& scope, const auto& visit) {
  const py::list names(py::dict(scope.attr("__dict__")).attr("keys")());
  for (const py::handle each : names) {
    const auto name = each.cast<std::string>();
    if (name.starts_with('_') && name != "__init__") continue;
    const py::object found = scope.attr(name.c_str());
    const py::handle function = py::detail::get_function(found);
    if (PyCFunction_Check(function.ptr())) visit(name, found);
  }
}

}  // namespace

void explain_arguments(py::module_& module) {
  for_each_function(module, [&](const std::string& name, const py::object& function) {
    module.attr(name.c_str()) = overload_of_function(module, name, function);
  });
  const py::list names(py::dict(module.attr("__dict__")).attr("keys")());
  for (const py::handle each : names) {
    const py::object type = module.attr(each);
    if (!PyType_Check(type.ptr()) || each.cast<std::string>().starts_with('_')) continue;
    for_each_function(type, [&](const std::string& name, const py::object& method) {
      type.attr(name.c_str()) = name == "__init__" ? overload_of_constructor(type, method)
                                                   : overload_of_method(type, name, method);
    });
  }
}

}  // namespace eses::python
