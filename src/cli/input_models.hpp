#pragma once
/// The models of the input files of a command with `--model all`.

#include <cstddef>
#include <exception>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "eses/read_atoms.hpp"
#include "run/request.hpp"

namespace eses::detail::cli {

/// Options that a command with `--model all` has beside others.
struct ModelOptions {
  std::vector<std::filesystem::path> inputs;  ///< without folders; `-` is standard input
  AtomFormat format = AtomFormat::automatic;
  StructureOptions structure;  ///< for PDB and mmCIF files
  bool all_models = false;     ///< whether each model of a file is measured
  /// With `all_models`, the number of the model of each input; 0 if it is not known.
  std::vector<int> models = {};

  /// With `all_models`, replaces each input by its models. Files that cannot be read stay, so that
  /// they are reported with the others.
  void expand_models();

  /// Whether the results of several inputs or models are printed.
  bool has_many() const { return inputs.size() > 1 || all_models; }

  /// Returns the number of the model of an input; 0 for the first one.
  int model_of(std::size_t input) const { return models.empty() ? structure.model : models[input]; }

  /// Returns the name of a table of an input. Each model has a table, if each is measured.
  std::string name_of_table(std::size_t input, std::string_view ending) const;

  /// Returns the message of an error, with the name of the input and its model.
  std::string message_of_input(const std::exception& error, std::size_t input) const;
};

/// Throws UsageError if an input has no models: standard input, and other files than PDB and mmCIF.
void require_models(const InputFile& input);

}  // namespace eses::detail::cli
