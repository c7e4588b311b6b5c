#include "input/advice.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <numeric>
#include <system_error>
#include <vector>

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

/// Returns the number of letters to insert, delete or replace (Levenshtein).
std::size_t distance_of(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
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

std::string_view closest_name(std::string_view word, const std::vector<std::string>& names) {
  constexpr std::size_t min_length = 4;
  const std::size_t letters = word.size() - std::min(word.find_first_not_of('-'), word.size());
  const std::size_t max_distance = letters < min_length ? 1 : 2;
  if (word.size() < min_length) return {};
  std::string_view best;
  std::size_t least = max_distance + 1;
  for (const std::string& name : names) {
    if (name.starts_with(word)) return name;
    if (const std::size_t distance = distance_of(word, name); distance < least) {
      least = distance;
      best = name;
    }
  }
  return best;
}

}  // namespace eses::detail
