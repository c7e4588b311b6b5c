
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "cli/interruption.hpp"
#include "cli/messages.hpp"
#include "cli/msms.hpp"
#include "eses/error.hpp"
#include "eses/version.hpp"
#include "input/read_input.hpp"
#include "input/text_source.hpp"
#include "output/file.hpp"
#include "output/file_path.hpp"
#include "output/mesh_formatter.hpp"
#include "output/output_directory.hpp"
#include "output/text_buffer.hpp"
#include "run/far_atoms.hpp"
#include "run/request.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

/// Radius of hydrogens in the files of pdb_to_xyzr, which -noh ignores, in angstrom.
constexpr double hydrogen_radius = 1.2;
constexpr double radius_tolerance = 1e-6;  // angstrom; radii have at most six decimals

/// The spheres that are used, and all spheres of the file.
struct Input {
  SphereFile file;
  std::vector<Atom> used;
  std::vector<FileIndex> file_indices;  ///< by index of a used sphere
  std::size_t hydrogen_count = 0, empty_count = 0;

  std::string_view name(AtomIndex used_index) const {
    return file.names.empty() ? std::string_view()
                              : file.names[as_number(file_indices[used_index])];
  }
};

Input read_input(const MsmsOptions& options) {
  Input input;
  input.file = read_spheres(options.input);
  for (AtomIndex i = 0; i < input.file.spheres.size(); ++i) {
    const Atom& sphere = input.file.spheres[i];
    if (sphere.radius == 0) {
      ++input.empty_count;
    } else if (!options.has_hydrogens &&
               std::fabs(sphere.radius - hydrogen_radius) < radius_tolerance) {
      ++input.hydrogen_count;
    } else {
      input.used.push_back(sphere);
      input.file_indices.push_back(FileIndex{i});
    }
  }
  if (input.used.empty())
    throw Error(formatted("{}: all {} spheres are ignored: {} of radius 0, {} of radius {}",
                          options.input.string(), input.file.spheres.size(), input.empty_count,
                          input.hydrogen_count, hydrogen_radius));
  return input;
}

/// Names spheres that make the grid large and empty, or refuses them.
void warn_about_far_spheres(const MsmsOptions& options, const Input& input) {
  std::vector<std::uint64_t> lines;
  for (const FileIndex i : input.file_indices) lines.push_back(input.file.lines[as_number(i)]);
  if (const auto far = require_dense_grid(input.used, options.probe_radius, msms_grid(options),
                                          input_name(options.input), lines, options.allow_far_atoms,
                                          "use a lower -density, "))
    print_message("warning", far->message);
}

/// Returns the indices of used spheres that the file numbers so.
std::vector<AtomIndex> used_indices(const std::vector<std::uint64_t>& wanted, const Input& input) {
  std::vector<AtomIndex> indices;
  for (const std::uint64_t atom : wanted) {
    const bool is_in_file = atom < input.file.spheres.size();
    const auto index = static_cast<FileIndex>(atom);
    const auto found =
        std::lower_bound(input.file_indices.begin(), input.file_indices.end(), index);
    if (!is_in_file || found == input.file_indices.end() || *found != index)
      throw Error(formatted(
          "-one_cavity names atom {}, {}", atom,
          is_in_file ? std::string("which is ignored")
                     : formatted("and the last one is {}", input.file.spheres.size() - 1)));
    indices.push_back(static_cast<AtomIndex>(found - input.file_indices.begin()));
  }
  return indices;
}

/// Returns the components that are written and printed, in order.
std::vector<std::uint32_t> chosen_components(const MsmsOptions& options, const Input& input,
                                             const MsmsSurface& surface) {
  if (!options.cavity_atoms.empty())
    return {surface.component_at(used_indices(options.cavity_atoms, input))};
  std::vector<std::uint32_t> components(options.has_all_components ? surface.components.all.size()
                                                                   : 1);
  std::iota(components.begin(), components.end(), std::uint32_t{0});
  return components;
}

// --- the messages --------------------------------------------------------------------------------

std::string input_text(const MsmsOptions& options, const Input& input) {
  const auto [least, greatest] =
      std::minmax_element(input.used.begin(), input.used.end(),
                          [](const Atom& a, const Atom& b) { return a.radius < b.radius; });
  std::string text =
      formatted("MSMS 2.6.1 interface of eses-blocks {}\n", version) +
      formatted("INPUT  {} {} spheres 0 collision only, radii {:6.3f} to {:6.3f}\n",
                options.input.string(), input.used.size(), least->radius, greatest->radius) +
      formatted("PARAM  Probe_radius {:6.3f} density {:6.3f} hdensity {:6.3f}\n",
                options.probe_radius, options.density, options.high_density);
  if (input.empty_count > 0)
    text += formatted("    {} spheres ignored, radius = 0\n", input.empty_count);
  if (input.hydrogen_count > 0)
    text +=
        formatted("    {} spheres ignored, radius = {}\n", input.hydrogen_count, hydrogen_radius);
  return text;
}

std::string analytical_text(const MsmsOptions& options, const MsmsSurface& surface,
                            const std::vector<std::uint32_t>& components) {
  std::string text =
      "ANALYTICAL SURFACE AREA :\n"
      "    Comp. probe_radius,   reent,    toric,   contact    SES       SAS\n";
  for (std::size_t i = 0; i < components.size(); ++i) {
    const MsmsAreas& areas = surface.areas[components[i]];
    text += formatted("{:7} {:11.3f} {:11.3f} {:9.3f} {:9.3f} {:9.3f} {:9.3f}\n", i,
                      options.probe_radius, areas.ses.concave, areas.ses.saddle, areas.ses.convex,
                      areas.ses.total(), areas.sas);
  }
  return text;
}

std::string numerical_text(const MsmsOptions& options, const MsmsSurface& surface,
                           const std::vector<std::uint32_t>& components) {
  std::string text =
      "TRIANGULATION...\n"
      "NUMERICAL VOLUMES AND AREA\n"
      "    Comp. probe_radius SES_volume SES_area)\n";
  double volume = 0;
  for (std::size_t i = 0; i < components.size(); ++i) {
    const mesh::Shell& shell = surface.components.all[components[i]];
    text += formatted("{:8} {:9.2f} {:12.3f} {:10.3f}\n", i, options.probe_radius, shell.volume,
                      shell.area);
    volume += shell.volume;
  }
  return text + formatted("    Total ses_volume: {:9.3f}\n", volume);
}

std::string surface_text(const MsmsOptions& options, const MsmsSurface& surface,
                         const std::vector<std::uint32_t>& components) {
  std::string text;
  for (std::size_t i = 0; i < components.size(); ++i)
    text += formatted("    RS component {} identified\n", i);
  if (options.has_areas) text += analytical_text(options, surface, components);
  if (options.has_triangles) text += numerical_text(options, surface, components);
  return text + "MSMS terminated normally\n";
}

/// Warns about outer surfaces that are not written.
void warn_about_others(const MsmsOptions& options, const MsmsSurface& surface) {
  if (options.has_all_components || !options.cavity_atoms.empty()) return;
  const auto& all = surface.components.all;
  const auto outer = std::count_if(all.begin(), all.end(),
                                   [](const mesh::Shell& shell) { return shell.volume > 0; });
  if (outer > 1)
    print_message("warning",
                  formatted("{} of {} outer surfaces left out; -all_components includes them",
                            outer - 1, outer));
}

// --- the files -----------------------------------------------------------------------------------

std::filesystem::path directory_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : ".";
}

/// Returns the path of the triangles of a component without suffix: NAME, NAME_1, NAME_2 and so on.
std::filesystem::path component_path(const MsmsOptions& options, std::size_t component) {
  std::filesystem::path path = options.surface;
  if (component > 0) path += formatted("_{}", component);
  return path;
}

/// Returns whether a name is that of the triangles of a component, of this or another run.
bool is_of_component(const MsmsOptions& options, std::string_view name) {
  const std::string start = options.surface.filename().string();
  if (!name.starts_with(start) || !(name.ends_with(".vert") || name.ends_with(".face")))
    return false;
  name.remove_prefix(start.size());
  name.remove_suffix(std::string_view(".vert").size());
  return name.empty() || (name.size() > 1 && name.starts_with('_') && name[1] != '0' &&
                          name.find_first_not_of("0123456789", 1) == name.npos);
}

/// The files of a run, which appear together or not at all. Symbolic links are followed, as by the
/// other commands.
class Files {
 public:
  /// Checks and locks the files that every run with these options writes, and those of further
  /// components that an earlier run has left, which will be removed.
  explicit Files(const MsmsOptions& options) : options_(options) {
    if (has_triangles()) add_component(0);
    if (!options.areas.empty()) {
      std::filesystem::path path = options.areas;
      if (path.extension() != ".area") path += ".area";
      add(path);
    }
    if (has_triangles()) find_stale();
    const std::array read{ReadFile{options.input, "the input"}};
    const ReadFiles input(read);
    for (const FilePath& path : paths_) input.refuse(path.text());
    for (const FilePath& path : stale_) input.refuse(path.text(), "removed; choose another name");
    lock();
  }

  bool has_triangles() const { return !options_.surface.empty() && options_.has_triangles; }

  /// Throws Interrupted after a signal.
  void check() {
    if (interruptible_) interruptible_->check();
  }

  /// Creates the files, with those of this number of components.
  void create(std::size_t components) {
    if (has_triangles())
      for (std::size_t i = 1; i < components; ++i) add_component(i);
    lock();
    for (std::size_t i = 0; i < paths_.size(); ++i)
      files_.push_back(std::make_unique<OutputFile>(*directories_[i], paths_[i].name));
  }

  TextSink vertices(std::size_t component) { return sink(index_of(component)); }
  TextSink triangles(std::size_t component) { return sink(index_of(component) + 1); }
  TextSink areas() { return sink(has_triangles() ? 2 : 0); }

  void commit() {
    commit_all(files_, [this] {
      // A symbolic link to a file that is written stays.
      for (const FilePath& stale : stale_)
        if (std::find(paths_.begin(), paths_.end(), end_of_links(stale.text())) == paths_.end())
          directories_.front()->remove(stale.name);
    });
  }

 private:
  /// The areas come behind the first component, which is known before.
  std::size_t index_of(std::size_t component) const {
    return 2 * component + (component > 0 && !options_.areas.empty() ? 1U : 0U);
  }

  TextSink sink(std::size_t index) {
    return [this, index](std::string_view text) {
      check();
      files_[index]->append(text);
    };
  }

  void add(const std::filesystem::path& file) {
    FilePath path = require_end_of_links(file);
    require_free_name(path);
    if (std::find(paths_.begin(), paths_.end(), path) != paths_.end())
      throw Error(formatted("two of the files would be the same one: {}; choose another name",
                            path.text()));
    paths_.push_back(std::move(path));
  }

  void add_component(std::size_t component) {
    for (const char* const suffix : {".vert", ".face"}) {
      std::filesystem::path path = component_path(options_, component);
      add(path += suffix);
    }
  }

  void find_stale() {
    std::error_code error;  // if the directory does not exist yet
    const std::filesystem::path directory = directory_of(options_.surface);
    for (const auto& entry : std::filesystem::directory_iterator(directory, error))
      if (const std::string name = entry.path().filename(); is_of_component(options_, name))
        stale_.push_back({directory.native(), name});
  }

  /// Locks the files that are not locked yet. A signal removes all of them.
  void lock() {
    OutputPaths paths;
    for (const auto& [directory, name] : paths_) {
      paths.add(directory, name);
      paths.locks.push_back(lock_path(directory, name));
    }
    interruptible_.reset();
    interruptible_.emplace(std::move(paths));
    for (std::size_t i = directories_.size(); i < paths_.size(); ++i) {
      directories_.push_back(
          std::make_unique<OutputDirectory>(paths_[i].directory, paths_[i].name));
      if (i == 0)
        directories_[i]->remove_abandoned(
            [&](std::string_view name) { return is_of_component(options_, name); });
    }
    interruptible_->hold_locks();
  }

  const MsmsOptions& options_;
  std::vector<FilePath> paths_, stale_;
  std::optional<InterruptibleRun> interruptible_;
  std::vector<std::unique_ptr<OutputDirectory>> directories_;  // by file
  std::vector<std::unique_ptr<OutputFile>> files_;
};

/// A component, and the header of its files.
struct ComponentWriter {
  const MsmsOptions& options;
  const Input& input;
  const MsmsSurface& surface;
  std::uint32_t component;

  void write_header(bool has_faces, std::uint64_t count, BufferedText& text) const {
    if (options.has_header)
      mesh::append_msms_header(text, names_of(SurfaceKind::ses).name, has_faces, count,
                               input.used.size(), options.density, options.probe_radius);
  }

  /// Writes the vertices. Returns the number of each vertex within the component.
  std::vector<std::uint64_t> write_vertices(const TextSink& sink) const {
    BufferedText text(sink);
    write_header(false, surface.components.all[component].vertex_count, text);
    std::vector<std::uint64_t> numbers(surface.vertices.size());
    std::uint64_t count = 0;
    std::string line;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (surface.components.of_vertex[i] != component) continue;
      numbers[i] = count++;
      const AtomIndex closest = surface.closest_atoms[i];
      const std::string_view name = input.name(closest);
      line.resize(mesh::max_msms_vertex_bytes + 1 + name.size());
      const MsmsVertex& vertex = surface.vertices[i];
      const char* const end =
          mesh::put_msms_vertex(line.data(), vertex.position, vertex.normal, vertex.patch,
                                input.file_indices[closest], name);
      text.append("{}", std::string_view(line.data(), end));
    }
    text.flush();
    return numbers;
  }

  void write_triangles(const std::vector<std::uint64_t>& numbers, const TextSink& sink) const {
    BufferedText text(sink);
    write_header(true, surface.components.all[component].triangle_count, text);
    std::array<char, mesh::max_msms_triangle_bytes> line;
    for (const mesh::Triangle& triangle : surface.triangles) {
      if (surface.components.of_vertex[triangle[0]] != component) continue;
      mesh::Triangle local{};
      std::array<std::uint8_t, 3> patches{};
      for (std::size_t corner = 0; corner < local.size(); ++corner) {
        local[corner] = numbers[triangle[corner]];
        patches[corner] = surface.vertices[triangle[corner]].patch;
      }
      const char* const end = mesh::put_msms_triangle(line.data(), local, mesh::patch_of(patches));
      text.append("{}", std::string_view(line.data(), end));
    }
    text.flush();
  }
};

void write_triangles(const MsmsOptions& options, const Input& input, const MsmsSurface& surface,
                     const std::vector<std::uint32_t>& components, Files& files) {
  for (std::size_t i = 0; i < components.size(); ++i) {
    const ComponentWriter writer{options, input, surface, components[i]};
    writer.write_triangles(writer.write_vertices(files.vertices(i)), files.triangles(i));
  }
}

/// Writes a line for each sphere of the file; the areas of ignored spheres are 0.
void write_areas(const Input& input, const MsmsSurface& surface,
                 const std::vector<std::uint32_t>& components, const TextSink& sink) {
  BufferedText text(sink);
  text.append("Atom#");
  for (std::size_t i = 0; i < components.size(); ++i)
    text.append(" {:>11} {:>11}", formatted("ses_{}", i), formatted("sas_{}", i));
  text.append("\n");
  AtomIndex next = 0;  // index of the next used sphere
  for (AtomIndex i = 0; i < input.file.spheres.size(); ++i) {
    const bool is_used = next < input.used.size() && input.file_indices[next] == FileIndex{i};
    text.append("{:5}", i);
    for (const std::uint32_t component : components) {
      MsmsAreas areas;
      const auto found =
          is_used ? surface.atom_areas.find({next, component}) : surface.atom_areas.end();
      if (found != surface.atom_areas.end()) areas = found->second;
      text.append(" {:11.6f} {:11.6f}", areas.ses.total(), areas.sas);
      if (!input.file.names.empty()) text.append(" {}", input.file.names[i]);
    }
    text.append("\n");
    next += static_cast<AtomIndex>(is_used);
  }
  text.flush();
}

}  // namespace

int perform_msms(const Arguments& arguments) {
  end_on_signals();
  const MsmsOptions options = parse_msms_arguments(arguments);
  require_standard_output();
  Files files(options);
  const Input input = read_input(options);
  print(input_text(options, input));
  warn_about_far_spheres(options, input);
  const MsmsSurface surface = make_msms_surface(input.used, options, [&] { files.check(); });
  const std::vector<std::uint32_t> components = chosen_components(options, input, surface);
  files.create(components.size());
  if (files.has_triangles()) write_triangles(options, input, surface, components, files);
  if (!options.areas.empty()) write_areas(input, surface, components, files.areas());
  files.commit();
  warn_about_others(options, surface);
  print(surface_text(options, surface, components));
  return exit_done;
}

}  // namespace eses::detail::cli
