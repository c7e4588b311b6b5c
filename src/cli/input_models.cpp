#include "cli/input_models.hpp"

#include <utility>

#include "cli/command.hpp"
#include "cli/shared_report.hpp"
#include "cli/table_files.hpp"
#include "eses/error.hpp"
#include "input/other_formats.hpp"
#include "input/read_input.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {

void ModelOptions::expand_models() {
  if (!all_models) return;
  std::vector<std::filesystem::path> expanded;
  for (const std::filesystem::path& path : inputs) {
    std::vector<int> numbers;
    try {
      numbers = read_model_numbers(path, {.format = format});
    } catch (const Error&) {
    }
    if (numbers.empty()) numbers.push_back(0);
    expanded.insert(expanded.end(), numbers.size(), path);
    models.insert(models.end(), numbers.begin(), numbers.end());
  }
  inputs = std::move(expanded);
}

std::string ModelOptions::name_of_table(std::size_t input, std::string_view ending) const {
  const std::string model = models.empty() ? "" : formatted(".model{}", models[input]);
  return table_name(inputs[input], model + std::string(ending));
}

std::string ModelOptions::message_of_input(const std::exception& error, std::size_t input) const {
  const int model = models.empty() ? 0 : models[input];
  return message_with_file(error, inputs[input]) +
         (model > 0 ? formatted(" (model {})", model) : "");
}

void require_models(const InputFile& input) {
  if (input.path == "-")
    throw UsageError("--model all reads the file once for each model; give its name");
  if (!is_structure(format_of(input.path, input.format)))
    throw UsageError(
        formatted("--model all needs PDB or mmCIF files; {} is read as PQR", input.path.string()));
}

}  // namespace eses::detail::cli
