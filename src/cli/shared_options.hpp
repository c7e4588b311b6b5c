#pragma once
/// Options of the input that several commands have.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/arguments.hpp"
#include "cli/complex_parts.hpp"
#include "eses/read_atoms.hpp"
#include "run/request.hpp"

namespace eses::detail::cli {

/// Adds --format.
void add_format(
    CLI::App& app, AtomFormat& format,
    const std::string& description = "auto (by suffix), xyzr, pqr, pdb or mmcif [auto]");

/// Adds an option that takes atoms of parts, as part_selector_in reads them.
CLI::Option* add_parts(CLI::App& app, const std::string& name, const std::string& value_name,
                       const std::string& description, std::vector<PartSelector>& parts);

/// Adds --threads.
void add_threads(CLI::App& app, int& threads);

/// Adds --fill-cavities. Without a value it fills all cavities.
void add_fill_cavities(CLI::App& app, std::optional<double>& max_filled_void);

/// Adds the options for PDB and mmCIF files, in a group of their own. If `all_models` is not null,
/// `--model all` is accepted and sets it.
void add_structure_options(CLI::App& app, StructureOptions& structure, bool* all_models = nullptr);

/// Returns whether there is no input of this name. `-` is standard input. Options are not compared
/// with the format of such a file, as the error about the file is clearer.
bool is_missing(const std::filesystem::path& input);

/// Throws UsageError if an option for PDB and mmCIF files is given with a file of another format.
void refuse_structure_options(const CLI::App& app, const InputFile& input);

/// Throws UsageError if the input is an xyzr file, which does not have the names that an option
/// needs.
void refuse_xyzr(const InputFile& input, std::string_view option, std::string_view names);

}  // namespace eses::detail::cli
