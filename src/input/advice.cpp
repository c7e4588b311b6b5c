#include "input/advice.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <system_error>

#include "input/text_fields.hpp"
#include "system/gzip.hpp"

namespace eses::detail {
namespace {

/// Returns a file name as a word of a shell command: in single quotes if it needs them, and with ./
/// before a leading hyphen.
std::string shell_word(const std::string& name) {
  const std::string path = name.starts_with('-') ? "./" + name : name;
  const bool is_plain = std::all_of(path.begin(), path.end(), [](char c) {
    return is_letter(c) || is_digit(c) ||
           std::string_view("._-/+=:,@%").find(c) != std::string::npos;
  });
  if (is_plain) return path;
  std::string word = "'";
  for (const char c : path) word += c == '\'' ? "'\\''" : std::string(1, c);
  return word + "'";
}

/// Returns the name of a file of an advised command. The name of its output is another one if a
/// file has it.
std::string file_of_command(const std::string& stem, std::string_view suffix) {
  constexpr std::string_view outputs = ".pdb .cif .pqr .xyzrn";
  std::string name = stem + std::string(suffix);
  std::error_code error;
  for (std::string to = stem; has_word(outputs, suffix) && std::filesystem::exists(name, error);)
    name = (to += ".converted") + std::string(suffix);
  return name;
}

}  // namespace

std::string advice_for(std::string_view file, std::string_view advice) {
  constexpr std::string_view word = "FILE";
  // Names in quotation marks cannot be in a quoted command.
  const bool is_quoted = advice.find('\'') != advice.npos;
  if (file.starts_with('<') || (is_quoted && shell_word(std::string(file)) != file))
    return std::string(advice);
  std::filesystem::path stem(file);
  if (lower_case(stem.extension().string()) == gzip_suffix) stem.replace_extension();
  stem.replace_extension();
  std::string text;
  for (std::size_t at = advice.find(word); at != advice.npos; at = advice.find(word)) {
    text += advice.substr(0, at);
    advice.remove_prefix(at + word.size());
    const std::size_t end = std::min(advice.find_first_of(" `;'"), advice.size());
    const bool has_suffix = advice.starts_with('.');
    text += shell_word(has_suffix ? file_of_command(stem.string(), advice.substr(0, end))
                                  : std::string(file));
    if (has_suffix) advice.remove_prefix(end);
  }
  return text.append(advice);
}

}  // namespace eses::detail
