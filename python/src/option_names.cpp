#include "option_names.hpp"

#include <array>
#include <regex>
#include <string>
#include <utility>

namespace eses::python {

std::string with_python_names(const std::string& message) {
  if (message.find("--") == std::string::npos) return message;
  // A blank or a parenthesis precedes the options in messages, but rarely two hyphens in file
  // names.
  static constexpr std::array<std::pair<const char*, const char*>, 6> names{
      {{"unknown-radius", "unknown_radius="},
       {"format (\\w+)", "format='$2'"},
       {"(model|assembly) (\\w+)", "$2=$3"},
       {"waters", "waters=True"},
       {"(select|chains): ", "$2: "},
       {"(format|model|assembly|select|chains|altloc|radii)", "$2="}}};
  std::string text = message;
  for (const auto& [option, name] : names)
    text = std::regex_replace(text, std::regex(std::string("(^|[ (])--") + option),
                              std::string("$1") + name);
  return text;
}

}  // namespace eses::python
