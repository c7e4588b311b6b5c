#include "atoms.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <cstdint>
#include <eses/eses.hpp>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "background.hpp"
#include "chosen_surface.hpp"
#include "instances.hpp"
#include "measure_records.hpp"
#include "read_file.hpp"
#include "warn.hpp"

namespace eses::python {
namespace {

constexpr const char* read_atoms_text =
    R"(read_atoms(path, *, format='auto', radii='protor', unknown_radius=None, model=0, altloc='', waters=False, hetatm=True, hydrogens='auto', chains=(), select='', assembly='', chain_names='auth')
--

Read the atoms of a file.

Parameters
----------
path : str, bytes, os.PathLike or file object
    Name of the file, which may be gzipped, or an open file.
format : {'auto', 'xyzr', 'pqr', 'pdb', 'mmcif'}, optional
    Format of the file. With ``auto`` the suffix decides: ``.pqr``, ``.pdb``, ``.pdb1``, ``.pdb2`` and so
    on, ``.ent``, ``.cif``, ``.mmcif``, ``.mcif`` and ``.pdbx``, each also with ``.gz``. For open files
    whose name has no such suffix, the first lines decide. Everything else is xyzr, which has one atom a line as ``x y z radius``. The arguments below are for PDB and mmCIF
    files.
radii : str or os.PathLike, optional
    Set of radii: ``protor``, ``bondi``, ``msms``, ``naccess``, ``oons``, also with ``+shannon`` for ions;
    ``occupancy`` if the file has radii as its occupancies; or the path of a file in FreeSASA's
    configuration format.
unknown_radius : float, optional
    Radius of atoms for which the set has none, in angstrom. Without it such atoms are an error.
model : int, optional
    Number of the model; 0 for the first one. PQR files have models, too.
altloc : str, optional
    Alternate location, such as ``A``; empty for that of the highest occupancy in each residue.
waters : bool, optional
    Whether water molecules are read.
hetatm : bool, optional
    Whether HETATM records other than water are read.
hydrogens : {'auto', 'keep', 'drop'}, optional
    Whether hydrogens are read; ``auto`` drops them if the radii are those of united atoms.
chains : sequence of str, optional
    Chains to read; empty for all.
select : str, optional
    Selection: chains (``A+B``), ``ligand:STI``, ``ligand``, or gemmi's syntax, such as ``/1/A/10-20/CA``.
assembly : str, optional
    Identifier of the biological assembly to build; empty for the atoms of the file.
chain_names : {'auth', 'label'}, optional
    Names of the chains of an mmCIF file: ``auth_asym_id``, those of the authors, or ``label_asym_id``,
    which differ for each ligand.

Returns
-------
Atoms
    Centres, radii and names of the atoms.

Raises
------
OSError
    If the file cannot be opened or read.
ValueError
    If the content of the file is not valid, or if there is no radius for an atom. The message
    names the file, the line and the field.
MemoryError
    If the atoms do not fit into memory.)";

constexpr const char* atoms_text = R"(Atoms of a file, in its order.

All arrays are read-only. Copy an array to change it.)";

constexpr const char* labels_text = R"(Names of the atoms of a file, as arrays of N strings.

Names that the file does not contain are empty. A name that is not UTF-8 is decoded as Latin-1.)";

AtomFormat format_named(const std::string& name) {
  if (name == "auto") return AtomFormat::automatic;
  if (name == "xyzr") return AtomFormat::xyzr;
  if (name == "pqr") return AtomFormat::pqr;
  if (name == "pdb") return AtomFormat::pdb;
  if (name == "mmcif") return AtomFormat::mmcif;
  throw py::value_error("format must be 'auto', 'xyzr', 'pqr', 'pdb' or 'mmcif', not '" + name +
                        "'");
}

HydrogenChoice hydrogens_named(const std::string& name) {
  if (name == "auto") return HydrogenChoice::by_radii;
  if (name == "keep") return HydrogenChoice::keep;
  if (name == "drop") return HydrogenChoice::drop;
  throw py::value_error("hydrogens must be 'auto', 'keep' or 'drop', not '" + name + "'");
}

ChainNames chain_names_named(const std::string& name) {
  if (name == "auth") return ChainNames::auth;
  if (name == "label") return ChainNames::label;
  throw py::value_error("chain_names must be 'auth' or 'label', not '" + name + "'");
}

ReadOptions read_options(const std::string& format, const std::filesystem::path& radii,
                         std::optional<double> unknown_radius, int model, const std::string& altloc,
                         bool waters, bool hetatm, const std::string& hydrogens,
                         const std::vector<std::string>& chains, const std::string& select,
                         const std::string& assembly, const std::string& chain_names) {
  return {.format = format_named(format),
          .structure = {.radii = radii.string(),
                        .unknown_radius = unknown_radius,
                        .model = model,
                        .altloc = altloc,
                        .with_waters = waters,
                        .with_hetatm = hetatm,
                        .hydrogens = hydrogens_named(hydrogens),
                        .chains = chains,
                        .select = select,
                        .assembly = assembly,
                        .chain_names = chain_names_named(chain_names)}};
}

// Reads the atoms of a text, whose format is known.
std::shared_ptr<AtomFile> parse(const py::bytes& text, const std::string& name,
                                const ReadOptions& options) {
  auto file = std::make_shared<AtomFile>();
  const std::string copy = text;
  read_file_as_value([&] {
    call_in_background([copy, name, options, file](const CheckCallback&) {
      *file = parse_atoms(copy, options.format, name, options.structure);
    });
  });
  return file;
}

// Reads the atoms of a path or an open file.
std::shared_ptr<AtomFile> read(const py::object& found, ReadOptions options) {
  if (py::hasattr(found, "read")) {
    const py::tuple opened =
        py::module_::import("eses_blocks._paths").attr("read_opened")(found, "auto");
    if (options.format == AtomFormat::automatic)
      options.format = format_named(opened[2].cast<std::string>());
    return parse(opened[0], opened[1].cast<std::string>(), options);
  }
  const std::filesystem::path path = path_of(found, " or an open file");
  // The library would read "-" from standard input, where Ctrl-C cannot interrupt it.
  if (path == "-") throw py::value_error("path must be the name of a file, not '-'");
  // A part of reading an mmCIF file is a single call of a parser, which takes seconds if the file
  // has millions of atoms.
  auto file = std::make_shared<AtomFile>();
  read_file_as_value([&] {
    call_in_background([path, options, file](const CheckCallback& check) {
      ReadOptions with_check = options;
      with_check.check = check;
      *file = read_atoms(path, with_check);
    });
  });
  return file;
}

// Reads the atoms, and warns of suspicious ones.
py::object read_and_warn(const py::object& found, const std::string& format,
                         const std::filesystem::path& radii, std::optional<double> unknown_radius,
                         int model, const std::string& altloc, bool waters, bool hetatm,
                         const std::string& hydrogens, const std::vector<std::string>& chains,
                         const std::string& select, const std::string& assembly,
                         const std::string& chain_names) {
  const auto file =
      read(found, read_options(format, radii, unknown_radius, model, altloc, waters, hetatm,
                               hydrogens, chains, select, assembly, chain_names));
  const py::object atoms = py::cast(file);
  const py::module_ paths = py::module_::import("eses_blocks._paths");
  const py::object name = paths.attr("name_of")(found);
  paths.attr("remember_files")(atoms, name, py::bytes(radii.string()));
  warn_about(*file, name);
  return atoms;
}

// Returns the name of a set of radii, whether it has united atoms, and for each atom the radius,
// the element, whether they follow from the element and from the names, and the class in the set.
py::tuple radii_of(const std::vector<std::string>& residues, const std::vector<std::string>& names,
                   const std::vector<std::string>& elements, const std::filesystem::path& set) {
  if (residues.size() != names.size() || elements.size() != names.size())
    throw py::value_error("residues, names and elements differ in length");
  std::vector<AtomLabel> labels(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    labels[i].residue = residues[i];
    labels[i].atom_name = names[i];
    labels[i].element = elements[i];
  }
  NamedRadii found;
  read_file_as_value([&] { found = find_radii(labels, set.string()); });
  py::list radii, symbols, by_element, by_name, classes;
  for (const NamedRadius& atom : found.atoms) {
    radii.append(atom.radius);
    symbols.append(atom.element);
    by_element.append(atom.is_by_element);
    by_name.append(atom.is_element_by_name);
    classes.append(static_cast<int>(atom.atom_class));
  }
  return py::make_tuple(found.set, found.are_united, radii, symbols, by_element, by_name, classes);
}

// Returns labels of atoms, whose residues have indices.
std::vector<AtomLabel> labels_of(const std::vector<std::int64_t>& residue_indices,
                                 const std::vector<std::string>& residues,
                                 const std::vector<std::string>& names,
                                 const std::vector<std::string>& elements) {
  std::vector<AtomLabel> labels(names.size());
  for (std::size_t i = 0; i < names.size(); ++i)
    labels[i] = {
        {}, residues.at(i), std::to_string(residue_indices.at(i)), names[i], elements.at(i)};
  return labels;
}

using NamePairs = std::vector<std::pair<std::string, std::string>>;

// Returns the names of residues and atoms of a PDB or mmCIF file whose elements follow from them.
NamePairs guessed_names(const AtomFile& file) {
  NamePairs names;
  if (file.structure)
    for (const RadiusSource& source : file.structure->guessed_elements)
      names.emplace_back(source.residue, source.atom_name);
  return names;
}

// Returns the elements of the atoms of another library, the indices of those that are not its, and
// whether the atoms belong to water.
py::tuple correct(const std::vector<std::int64_t>& residue_indices,
                  const std::vector<std::string>& residues, const std::vector<std::string>& names,
                  const std::vector<std::string>& elements, const py::array_t<double>& centers) {
  std::vector<AtomLabel> labels = labels_of(residue_indices, residues, names, elements);
  std::vector<Vec3> positions;
  const auto values = centers.unchecked<2>();
  for (py::ssize_t i = 0; i < values.shape(0); ++i)
    positions.push_back({values(i, 0), values(i, 1), values(i, 2)});
  const std::vector<AtomIndex> changed = correct_elements(positions, labels);
  py::list symbols;
  for (const AtomLabel& label : labels) symbols.append(label.element);
  return py::make_tuple(symbols, changed, find_waters(labels));
}

// Warns of residues that are models of other kinds than all atoms. The indices are those of the
// atoms in the molecule.
void warn_about_residues(const std::vector<std::int64_t>& residue_indices,
                         const std::vector<std::string>& residues,
                         const std::vector<std::string>& names,
                         const std::vector<std::string>& elements,
                         const std::vector<AtomIndex>& indices) {
  std::vector<Diagnostic> found =
      check_residues(labels_of(residue_indices, residues, names, elements));
  for (Diagnostic& diagnostic : found)
    for (Diagnostic::Example& example : diagnostic.examples)
      example.atom = indices.at(example.atom);
  warn_about(found);
}

// Returns whether each atom is in a selection.
std::vector<bool> selected(const std::vector<std::array<std::string, 5>>& atoms,
                           const std::string& selection) {
  std::vector<AtomLabel> labels;
  labels.reserve(atoms.size());
  for (const auto& [chain, residue, number, name, element] : atoms)
    labels.push_back({chain, residue, number, name, element});
  return read_file_as_value([&] { return select_atoms(labels, selection); });
}

AreaReference reference_of(const std::string& name) {
  return name == "miller"   ? AreaReference::miller
         : name == "sander" ? AreaReference::sander
                            : AreaReference::tien;
}

std::string source_of_reference(const std::string& name) {
  return std::string(source_of(reference_of(name)));
}

// Returns the maximum area of a residue by its name and, if they are known, the names of its atoms;
// None for other residues.
std::optional<double> maximum_area(const std::string& reference, const std::string& residue,
                                   const std::vector<std::string>& names) {
  const AreaReference which = reference_of(reference);
  if (names.empty()) return max_sas_area(residue, which);
  std::vector<AtomLabel> labels;
  for (const std::string& name : names) labels.push_back({{}, residue, {}, name});
  return max_sas_area(labels, which);
}

// Labels share the memory of the file.
struct Labels {
  std::shared_ptr<const AtomFile> file;
};

py::object decode(const std::string& name) {
  const auto size = static_cast<py::ssize_t>(name.size());
  PyObject* text = PyUnicode_DecodeUTF8(name.data(), size, nullptr);
  if (text == nullptr) {
    PyErr_Clear();
    text = PyUnicode_DecodeLatin1(name.data(), size, nullptr);
  }
  if (text == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(text);
}

py::object names(const Labels& labels, std::string AtomLabel::*name) {
  return texts_of(*labels.file, labels.file->labels.size(), name);
}

// The names of a label in the order of a state.
constexpr std::array label_names{&AtomLabel::chain, &AtomLabel::residue, &AtomLabel::residue_number,
                                 &AtomLabel::atom_name, &AtomLabel::element};

py::tuple label_state(const Labels& labels) {
  py::tuple state(label_names.size());
  for (std::size_t i = 0; i < label_names.size(); ++i) state[i] = names(labels, label_names[i]);
  return state;
}

std::vector<AtomLabel> labels_of_state(const py::tuple& state) {
  const auto columns =
      unpack_state<std::array<std::vector<std::string>, label_names.size()>>(state);
  std::vector<AtomLabel> labels(columns[0].size());
  for (std::size_t i = 0; i < label_names.size(); ++i) {
    if (columns[i].size() != labels.size())
      throw py::value_error("the lists of names of the state differ in length");
    for (std::size_t atom = 0; atom < labels.size(); ++atom)
      labels[atom].*label_names[i] = columns[i][atom];
  }
  return labels;
}

py::object labels_or_none(const std::shared_ptr<AtomFile>& file) {
  if (file->labels.empty()) return py::none();
  return py::cast(Labels{file});
}

/// The counts of atoms of a PDB or mmCIF file that are left out, by the names in Python.
using LeftOut = std::map<std::string, std::uint64_t>;
constexpr std::array<std::pair<const char*, std::uint64_t StructureReport::*>, 9> left_out_counts{
    {{"chain", &StructureReport::dropped_chains},
     {"selection", &StructureReport::dropped_selection},
     {"water", &StructureReport::dropped_waters},
     {"hetatm", &StructureReport::dropped_hetatm},
     {"hydrogen", &StructureReport::dropped_hydrogens},
     {"altloc", &StructureReport::dropped_altlocs},
     {"dummy", &StructureReport::dropped_dummies},
     {"assembly", &StructureReport::dropped_assembly},
     {"image", &StructureReport::dropped_images}}};

LeftOut left_out_of(const AtomFile& file) {
  LeftOut counts;
  if (file.structure)
    for (const auto& [name, member] : left_out_counts)
      if (const std::uint64_t count = (*file.structure).*member; count > 0) counts[name] = count;
  return counts;
}

py::object read_only_counts(const AtomFile& file) {
  return py::module_::import("eses_blocks._read_only").attr("Counts")(left_out_of(file));
}

/// Returns what notes on the atoms of a PDB or mmCIF file tell: the model and the number of models,
/// chains that are segments, the number of atoms, and the assemblies with several operators or
/// without some of the atoms. None for other files.
py::object noted(const AtomFile& file) {
  if (!file.structure) return py::none();
  const StructureReport& report = *file.structure;
  py::list assemblies;
  for (const OtherAssembly& other : report.other_assemblies)
    assemblies.append(py::make_tuple(other.id, other.operators, other.atoms));
  return py::make_tuple(report.model, report.models, report.segment_chains,
                        report.atom_records + report.hetatm_records + report.waters, assemblies);
}

/// Returns the name of the set of radii of a PDB or mmCIF file; empty for other files.
std::string set_of(const AtomFile& file) { return file.structure ? file.structure->radii : ""; }

/// Returns the classes of the atoms in their set of radii; 0 without labels.
py::array_t<std::uint8_t> classes_of(const AtomFile& file) {
  auto classes = make_array<std::uint8_t>(static_cast<py::ssize_t>(file.atoms.size()));
  for (std::size_t i = 0; i < file.atoms.size(); ++i)
    classes.mutable_data()[i] =
        static_cast<std::uint8_t>(i < file.labels.size() ? file.labels[i].atom_class : AtomClass());
  return classes;
}

py::tuple atoms_state(const py::object& atoms) {
  const auto& file = atoms.cast<const AtomFile&>();
  const py::object labels = atoms.attr("labels");
  return py::make_tuple(atoms.attr("centers"), atoms.attr("radii"), atoms.attr("lines"),
                        labels.is_none() ? labels : label_state(labels.cast<const Labels&>()),
                        atoms.attr("charge"), atoms.attr("diagnostics"), left_out_of(file),
                        files_of(atoms), classes_of(file), set_of(file), guessed_names(file));
}

void set_atoms_state(py::detail::value_and_holder& self, const py::tuple& state) {
  const auto [centers, radii, lines, labels, charges, diagnostics, left_out, files, classes, set,
              guessed] =
      unpack_state<
          std::tuple<py::object, py::object, StateArray<std::uint64_t>, std::optional<py::tuple>,
                     std::optional<StateArray<double>>, std::vector<Diagnostic>, LeftOut, py::tuple,
                     StateArray<std::uint8_t>, std::string, NamePairs>>(state);
  AtomFile file;
  file.atoms = make_atoms(centers, radii);
  file.diagnostics = diagnostics;
  if (!set.empty()) file.structure.emplace().radii = set;
  for (const auto& [residue, name] : guessed)
    if (file.structure) file.structure->guessed_elements.push_back({residue, name, {}, 0});
  for (const auto& [name, member] : left_out_counts)
    if (const auto count = left_out.find(name); file.structure && count != left_out.end())
      (*file.structure).*member = count->second;
  require_shape(lines, file.atoms.size());
  file.lines.assign(lines.data(), lines.data() + lines.size());
  if (labels) file.labels = labels_of_state(*labels);
  if (labels && file.labels.size() != file.atoms.size())
    throw py::value_error("the numbers of atoms and names of the state differ");
  require_shape(classes, file.atoms.size());
  for (std::size_t i = 0; i < file.labels.size(); ++i)
    file.labels[i].atom_class = static_cast<AtomClass>(classes.data()[i]);
  if (charges) {
    require_shape(*charges, file.atoms.size());
    file.charges.assign(charges->data(), charges->data() + charges->size());
  }
  construct(self, std::move(file), files);
}

void bind_labels(py::module_& module) {
  py::class_<Labels> labels(module, "Labels", labels_text);
  labels.attr("__module__") = "eses_blocks";
  labels.def("__len__", [](const Labels& self) { return self.file->labels.size(); })
      .def("__repr__",
           [](const Labels& self) {
             return "<eses_blocks.Labels: " + std::to_string(self.file->labels.size()) + " atoms>";
           })
      .def_property_readonly(
          "chain", [](const Labels& self) { return names(self, &AtomLabel::chain); },
          "(N,) str: chain identifiers, such as A.")
      .def_property_readonly(
          "residue", [](const Labels& self) { return names(self, &AtomLabel::residue); },
          "(N,) str: residue names, such as ALA.")
      .def_property_readonly(
          "residue_number",
          [](const Labels& self) { return names(self, &AtomLabel::residue_number); },
          "(N,) str: residue numbers with the insertion code, such as 52A.")
      .def_property_readonly(
          "atom_name", [](const Labels& self) { return names(self, &AtomLabel::atom_name); },
          "(N,) str: atom names, such as CA.")
      .def(py::pickle(&label_state, [](const py::tuple& state) {
        auto file = std::make_shared<AtomFile>();
        file->labels = labels_of_state(state);
        return Labels{file};
      }));
  protect_instances(labels);
}

void bind_atoms_class(py::module_& module) {
  py::class_<AtomFile, std::shared_ptr<AtomFile>> atoms(module, "Atoms", atoms_text);
  atoms.attr("__module__") = "eses_blocks";
  atoms.def("__len__", [](const AtomFile& self) { return self.atoms.size(); })
      .def("__repr__",
           [](const AtomFile& self) {
             return "<eses_blocks.Atoms: " + std::to_string(self.atoms.size()) + " atoms>";
           })
      .def_property_readonly(
          "centers",
          [](const py::object& self) {
            return centers_view(self.cast<const AtomFile&>().atoms, self);
          },
          "(N, 3) float64: centres, in angstrom.")
      .def_property_readonly(
          "radii",
          [](const py::object& self) {
            return radii_view(self.cast<const AtomFile&>().atoms, self);
          },
          "(N,) float64: van der Waals radii, in angstrom.")
      .def_property_readonly(
          "lines",
          [](const py::object& self) {
            const auto& lines = self.cast<const AtomFile&>().lines;
            return field_view(lines.data(), lines.size(), sizeof(lines[0]), self);
          },
          "(N,) uint64: line numbers in the file, from 1.")
      .def_property_readonly("labels", &labels_or_none,
                             "Labels or None: names of the atoms; None if the file has none.")
      .def_readonly(
          "diagnostics", &AtomFile::diagnostics,
          "list of Diagnostic: suspicious names, such as those of a file of C-alpha atoms. "
          "``Surface.diagnostics`` has those of centres and radii.")
      .def_property_readonly("left_out", &read_only_counts,
                             "dict of str to int: numbers of the atoms of a PDB or mmCIF file that "
                             "are left out: ``chain``, "
                             "``selection``, ``water``, ``hetatm``, ``hydrogen``, ``altloc``, "
                             "``dummy``, ``assembly``, "
                             "``image``; without those that are 0.")
      .def_property_readonly(
          "element",
          [](const AtomFile& self) {
            return texts_of(self, self.atoms.size(), &AtomLabel::element);
          },
          "(N,) str: element symbols, such as Cl; empty if unknown, as in xyzr files.")
      .def_property_readonly(
          "charge",
          [](const py::object& self) -> py::object {
            const auto& charges = self.cast<const AtomFile&>().charges;
            if (charges.empty()) return py::none();
            return field_view(charges.data(), charges.size(), sizeof(double), self);
          },
          "(N,) float64 or None: charges of a PQR file, or of an mmCIF file with partial charges, "
          "in "
          "elementary charges; nan where the mmCIF file has none; None for other files.")
      .def("__getstate__", &atoms_state)
      .def("__setstate__", &set_atoms_state, py::detail::is_new_style_constructor());
  protect_instances(atoms);
}

void bind_reading(py::module_& module) {
  module.def("read_atoms", &read_and_warn, read_atoms_text, py::arg("path"), py::kw_only(),
             py::arg("format") = "auto", py::arg("radii") = "protor",
             py::arg("unknown_radius") = py::none(), py::arg("model") = 0, py::arg("altloc") = "",
             py::arg("waters") = false, py::arg("hetatm") = true, py::arg("hydrogens") = "auto",
             py::arg("chains") = py::tuple(), py::arg("select") = "", py::arg("assembly") = "",
             py::arg("chain_names") = "auth");
  py::class_<ReadOptions>(module, "_ReadOptions").def(py::init(&read_options));
  module.def("_read_atoms", &read);
  module.def("_parse_atoms", &parse);
  module.def("_warn_about",
             [](const AtomFile& file, const py::str& name) { warn_about(file, name); });
}

// What the package needs for molecules of files and of other libraries.
void bind_molecule_helpers(py::module_& module) {
  module.def("_noted", &noted);
  module.def("_set_of", &set_of);
  module.def("_classes_of", &classes_of);
  module.def("_find_radii", &radii_of);
  module.def("_correct_elements", &correct);
  module.def("_guessed_names", &guessed_names);
  module.def("_warn_about_residues", &warn_about_residues);
  module.def("_warn_about_stray_atoms", [](const ChosenSurface& surface,
                                           const py::array_t<std::int64_t>& kept) {
    warn_about_stray_atoms(surface, {kept.data(), static_cast<std::size_t>(kept.size())});
  });
  module.def("_select_atoms", &selected);
  module.def("_maximum_area", &maximum_area);
  module.def("_source_of_reference", &source_of_reference);
  module.attr("_reference_probe_radius") = reference_probe_radius;
}

}  // namespace

py::object texts_of(const AtomFile& file, std::size_t count, std::string AtomLabel::*member) {
  const py::module_ numpy = py::module_::import("numpy");
  if (file.labels.empty()) return read_only(numpy.attr("zeros")(count, py::arg("dtype") = "U1"));
  py::list values;
  for (const AtomLabel& label : file.labels) values.append(decode(label.*member));
  return read_only(numpy.attr("array")(values, py::arg("dtype") = "U"));
}

void bind_atoms(py::module_& module) {
  bind_labels(module);
  bind_atoms_class(module);
  bind_reading(module);
  bind_molecule_helpers(module);
}

}  // namespace eses::python
