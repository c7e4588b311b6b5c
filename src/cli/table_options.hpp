#pragma once
/// The options that `eses-blocks measure` and `interface` share: both take many files, with each
/// of their models, and write tables.

#include <cstddef>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/arguments.hpp"
#include "eses/read_atoms.hpp"
#include "eses/surface.hpp"
#include "input/radii_set.hpp"
#include "output/area_tables.hpp"
#include "run/request.hpp"

namespace eses::detail::cli {

/// Where the names of the input files come from.
struct InputChoice {
  std::vector<std::filesystem::path> paths;  ///< files and folders; `-` is standard input
  std::filesystem::path list;                ///< file of --files-from; empty if it is not given
  bool looks_in_folders = false;             ///< whether folders of folders are searched, too

  /// Returns the files, with those in the lines of the list, and with each folder replaced by the
  /// files in it whose names have a suffix of PDB, mmCIF, PQR or xyzr, in the order of their names.
  /// Files of areas that `--write` has written are left out of folders, with a note unless
  /// `is_quiet`. Throws UsageError if there are none, or if standard input is one of several, and
  /// Error if a list or folder cannot be read or is empty.
  std::vector<std::filesystem::path> files(bool is_quiet) const;
};

/// A table of `--write` or `--table`. That of the file NAME.pdb is written to NAME and `ending`.
struct Table {
  std::string_view name, ending;
  /// Requirements and contents, as bits that each command defines.
  unsigned traits = 0;
  /// Appends the table of the atoms of a file; null if the command has no such function.
  void (*append)(const MeasuredAtoms& atoms, BufferedText& text) = nullptr;

  bool has(unsigned trait) const { return (traits & trait) != 0; }
};

struct TableOptions {
  InputChoice choice;                         ///< as it was given
  std::vector<std::filesystem::path> inputs;  ///< without folders; `-` is standard input
  /// Why files of folders and lists cannot be measured with these options.
  std::map<std::filesystem::path, std::string> refusals = {};
  AtomFormat format = AtomFormat::automatic;
  StructureOptions structure;  ///< for PDB and mmCIF files
  RadiiSet radii = {};         ///< of `structure`, read once for all inputs
  bool all_models = false;     ///< whether each model of a file is measured
  /// With `all_models`, the number of the model of each input; 0 if it is not known.
  std::vector<int> models = {};
  double probe_radius = SurfaceOptions().probe_radius;
  std::span<const Table> tables = {};            ///< of the command
  std::vector<const Table*> written_tables;      ///< in the order of `tables`
  const Table* printed_table = nullptr;          ///< printed in place of the report; may be null
  std::filesystem::path output_directory = ".";  ///< of the tables
  std::filesystem::path csv;                     ///< file of --csv; empty if there is none
  bool prints_csv = false;  ///< whether the table of --csv is printed in place of the report
  /// With --resume, identifies the run (see identity.hpp): the options of the command that affect
  /// the results, and the content of the file of --radii.
  std::optional<std::string> identity = {};
  int threads = 0;  ///< 0 means all available processors
  bool json = false;
  bool quiet = false;
  bool strict = false;  ///< whether warnings are errors

  /// Whether the results of several inputs or models are printed.
  bool has_many() const { return inputs.size() > 1 || all_models; }

  /// Returns the number of the model of an input if each is measured; 0 if it is not known.
  std::optional<int> measured_model(std::size_t input) const {
    return models.empty() ? std::nullopt : std::optional(models[input]);
  }

  /// Returns the number of the model to read; 0 for the first one.
  int model_of(std::size_t input) const { return measured_model(input).value_or(structure.model); }

  /// Returns the options for reading an input.
  ReadOptions reading_of(std::size_t input, const CheckCallback& check) const;

  /// The tables to write or to print.
  std::vector<const Table*> needed_tables() const;

  /// Whether a table to write or to print has a trait.
  bool needs(unsigned trait) const;

  /// Returns the option that chooses a table, with its value, for messages.
  std::string option_of(const Table& table) const;

  /// Returns the name of a table of an input. Each model has a table, if each is measured.
  std::string name_of_table(std::size_t input, const Table& table) const;

  /// Returns the names of the tables of an input; none if it cannot be measured with the options.
  std::vector<std::string> names_of_tables(std::size_t input) const;

  /// Returns the line of a report about the written tables of an input; empty if there are none.
  std::string written_text(std::size_t input) const;

  /// Returns the name of an input, with ` (model N)` if each model is measured, for messages.
  std::string name_of_input(std::size_t input) const;

  /// Returns the message of an error, with the name of the input and its model.
  std::string message_of_input(const std::exception& error, std::size_t input) const;
};

/// Adds the argument FILE...
void add_input_files(CLI::App& app, const std::string& description, InputChoice& choice);

/// Adds --recursive and --files-from.
void add_input_lists(CLI::App& app, InputChoice& choice);

/// Adds --write and --table, which choose some of the tables and one of them. `tables` must outlive
/// the options.
void add_tables(CLI::App& app, std::span<const Table> tables, const std::string& description,
                TableOptions& options);

/// Adds the last options: --output-dir, --csv and --resume, those of structures and --threads, and
/// those of messages.
void add_last_options(CLI::App& app, TableOptions& options, const std::string& csv_description);

/// Sets the members that depend on several options, after the parsing. Throws UsageError if outputs
/// exclude each other, and the errors of InputChoice::files and find_radii_set.
void complete_table_options(const CLI::App& app, TableOptions& options);

/// Compares the options with the format of each input that exists, and calls `check` with it. A
/// UsageError goes on to the caller if the command line names the file. Otherwise its message is
/// kept in `refusals`, so that the other files are measured.
void check_inputs(const CLI::App& app, TableOptions& options,
                  const std::function<void(const InputFile& input)>& check);

/// With `--model all`, replaces each input by its models. Files that cannot be read stay, so that
/// they are reported with the others.
void expand_models(TableOptions& options);

}  // namespace eses::detail::cli
