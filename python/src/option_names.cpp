#include "option_names.hpp"

#include <regex>
#include <string>

namespace eses::python {

std::string with_python_names(const std::string& message) {
  if (message.find("--") == std::string::npos) return message;
  std::string text = std::regex_replace(message, std::regex("--unknown-radius"), "unknown_radius=");
  text = std::regex_replace(text, std::regex("--format (\\w+)"), "format='$1'");
  text = std::regex_replace(text, std::regex("--(model|assembly) (\\w+)"), "$1=$2");
  text = std::regex_replace(text, std::regex("--waters"), "waters=True");
  text = std::regex_replace(text, std::regex("--(select|chains): "), "$1: ");
  return std::regex_replace(
      text, std::regex("--(format|model|assembly|select|chains|altloc|radii)"), "$1=");
}

}  // namespace eses::python
