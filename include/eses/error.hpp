#pragma once
/// The exception that the library throws for anything a user can mend.

#include <stdexcept>
#include <string>

namespace eses {

/// An input, output or resource error. `what()` is one complete sentence fragment for the user:
/// it names the file (and line, where there is one), what is wrong and what was expected.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace eses
