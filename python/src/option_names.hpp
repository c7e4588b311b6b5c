#pragma once

#include <string>

namespace eses::python {

/// Returns a message in which the options of the program for reading files, such as `--model 2`,
/// are the arguments of Python, such as `model=2`.
std::string with_python_names(const std::string& message);

}  // namespace eses::python
