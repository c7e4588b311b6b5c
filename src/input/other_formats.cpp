#include "input/other_formats.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "eses/error.hpp"
#include "input/advice.hpp"
#include "input/atom_records.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"

namespace eses::detail {
namespace {

/// A format of molecules that cannot be read.
struct OtherFormat {
  std::string_view name;
  std::string_view suffixes;  ///< separated by blanks
  std::string_view advice;    ///< how to convert the file
};

constexpr std::string_view open_babel = "convert it with `obabel FILE -O FILE.pdb`";
constexpr std::string_view open_babel_or_python =
    "convert it with `obabel FILE -O FILE.pdb`, or use `eses.measure` in Python, which reads it "
    "with RDKit (doc/molecules.md)";
// Such files are often named .pdb, and must not be overwritten.
constexpr std::string_view open_babel_pdbqt =
    "convert it with `obabel -ipdbqt FILE -O FILE.converted.pdb`, or read it with --format pdb";
constexpr std::string_view gromacs = "convert it with `gmx editconf -f FILE -o FILE.pdb`";
constexpr std::string_view gromacs_trajectory =
    "write one frame with `gmx trjconv -f FILE -s TOPOLOGY.tpr -dump 0 -o FILE.pdb`";
constexpr std::string_view amber_topology =
    "make a PQR file of topology and coordinates with `ambpdb -p FILE -c FILE.inpcrd -pqr > "
    "FILE.pqr`";
constexpr std::string_view amber_coordinates =
    "make a PQR file of topology and coordinates with `ambpdb -p FILE.prmtop -c FILE -pqr > "
    "FILE.pqr`";
constexpr std::string_view cpptraj =
    "write the first frame with `cpptraj -p TOPOLOGY.prmtop -y FILE -ya '1 1' -x FILE.pdb`";
constexpr std::string_view pymol = "convert it with `pymol -cq FILE -d 'save FILE.pdb'`";
constexpr std::string_view trajectory =
    "write one frame with `mdconvert FILE -t TOPOLOGY -i 0 -o FILE.pdb`";

constexpr std::array other_formats{
    OtherFormat{"Tripos MOL2", ".mol2", open_babel_or_python},
    OtherFormat{"MDL molfile or SDF", ".sdf .mol .sd", open_babel_or_python},
    OtherFormat{"Amber topology", ".prmtop .parm7", amber_topology},
    OtherFormat{"Amber restart", ".inpcrd .rst7 .rst", amber_coordinates},
    OtherFormat{"Amber NetCDF", ".nc .ncrst .ncdf", cpptraj},
    OtherFormat{"HDF5", ".h5 .h5md",
                "write one frame as PDB; for files of MDTraj use `mdconvert FILE -i 0 -o "
                "FILE.pdb`"},
    OtherFormat{"CHARMM PSF", ".psf",
                "it has no coordinates; pass the PDB file that belongs to it, which is read "
                "directly"},
    OtherFormat{"CHARMM coordinate", ".crd .cor", open_babel},
    OtherFormat{"DCD trajectory", ".dcd", trajectory},
    OtherFormat{"GROMACS trajectory", ".xtc .trr", gromacs_trajectory},
    OtherFormat{"GROMACS coordinate", ".gro .g96 .tpr", gromacs},
    OtherFormat{"GROMACS or Amber topology", ".top",
                "it has no coordinates; with GROMACS use `gmx editconf -f FILE.gro -o FILE.pdb`, "
                "with Amber `ambpdb -p FILE -c FILE.inpcrd -pqr > FILE.pqr`"},
    OtherFormat{"mmJSON", ".json", "convert it with `gemmi convert FILE FILE.cif`"},
    OtherFormat{"PDBML", ".xml", "get the entry as .cif or .cif.gz, which are read directly"},
    OtherFormat{"NACCESS or FreeSASA area", ".rsa",
                "it has no coordinates; pass the PDB or mmCIF file from which it was made, as in "
                "`eses-blocks measure FILE.pdb --table rsa`"},
    OtherFormat{"MMTF", ".mmtf",
                "convert it with `pymol -cq FILE -d 'save FILE.cif'`, or get the entry as .cif"},
    OtherFormat{"BinaryCIF", ".bcif",
                "get the entry as .cif or .cif.gz, which are read directly, or use "
                "`eses.measure` in Python, which reads it with Biotite (doc/molecules.md)"},
    OtherFormat{"AutoDock PDBQT", ".pdbqt", open_babel_pdbqt},
    OtherFormat{"PyMOL session", ".pse", pymol},
    OtherFormat{"ChimeraX session", ".cxs",
                "convert it with `chimerax --nogui --exit --cmd 'open FILE; save FILE.pdb'`"},
    OtherFormat{"XYZ", ".xyz", open_babel},
    OtherFormat{"Maestro", ".mae .maegz", pymol},
};

/// Returns the first line that is neither blank nor a comment.
std::string_view first_line(std::string_view text) {
  while (!text.empty())
    if (const std::string_view line = without_leading_blanks(take_line(text));
        !line.empty() && line.front() != '#')
      return line;
  return {};
}

/// Returns whether the fourth line, the counts line, ends with the version.
bool is_molfile(std::string_view text) {
  for (int line = 0; line < 3; ++line) take_line(text);
  const std::string_view counts = without_trailing_blanks(take_line(text));
  return counts.ends_with("V2000") || counts.ends_with("V3000");
}

/// First bytes of the files of a format.
struct Magic {
  std::size_t offset;
  std::string_view bytes;
  std::string_view suffix;  ///< a suffix of the format
};

constexpr std::array magics{
    Magic{0, {"\0\0\x07\xcb", 4}, ".xtc"}, Magic{0, {"\0\0\x07\xc9", 4}, ".trr"},
    Magic{4, {"CORD", 4}, ".dcd"},         Magic{0, {"%VERSION", 8}, ".prmtop"},
    Magic{0, {"PSF ", 4}, ".psf"},         Magic{0, {"CDF\1", 4}, ".nc"},
    Magic{0, {"CDF\2", 4}, ".nc"},         Magic{0, {"\x89HDF\r\n", 6}, ".h5"},
};

// Maximum distance from the start of a text at which XML and MessagePack have their first keys.
constexpr std::size_t head_bytes = 512;

/// Returns a suffix of the format that the start of a text has; empty if it is none of these.
std::string_view suffix_by_content(std::string_view text) {
  for (const Magic& magic : magics)
    if (text.size() >= magic.offset && text.substr(magic.offset).starts_with(magic.bytes))
      return magic.suffix;
  const std::string_view line = first_line(text);
  if (line.starts_with("@<TRIPOS>")) return ".mol2";
  if (line.starts_with("{")) return ".json";
  const std::string_view head = text.substr(0, head_bytes);
  if (line.starts_with("REM ") && head.find("\nREM RES ") != head.npos) return ".rsa";
  if (line.starts_with("<") && head.find("PDBx:datablock") != head.npos) return ".xml";
  const bool is_map = !text.empty() && static_cast<unsigned char>(text.front()) >= 0x80;
  if (is_map && head.find("mmtfVersion") != head.npos) return ".mmtf";
  if (is_map && (head.find("dataBlocks") != head.npos || head.find("encoder") != head.npos))
    return ".bcif";
  if (is_molfile(text)) return ".sdf";
  return {};
}

/// Throws Error if a text starts with the byte order mark of UTF-16 or UTF-32.
void refuse_wide_characters(std::string_view text, std::string_view name) {
  constexpr std::string_view little_32("\xff\xfe\0\0", 4), big_32("\0\0\xfe\xff", 4);
  std::string_view encoding;
  // The mark of UTF-32 begins with the mark of UTF-16.
  if (text.starts_with(little_32) || text.starts_with(big_32))
    encoding = "UTF-32";
  else if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    encoding = "UTF-16";
  if (!encoding.empty())
    throw Error(formatted("{}:1: {} text; convert the file to UTF-8 first", name, encoding));
}

/// Returns AtomFormat::pdb or AtomFormat::mmcif if the start of a text has that format, otherwise
/// AtomFormat::automatic.
AtomFormat structure_format_of(std::string_view text) {
  const std::string_view line = first_line(text);
  if (starts_with_ignoring_case(line, "data_")) return AtomFormat::mmcif;
  for (const std::string_view record :
       {"HEADER ", "OBSLTE ", "TITLE ", "COMPND ", "EXPDTA ", "CRYST1 ", "NUMMDL "})
    if (line.starts_with(record)) return AtomFormat::pdb;
  return AtomFormat::automatic;
}

}  // namespace

std::string input_suffix(const std::filesystem::path& path) {
  std::string suffix = lower_case(path.extension().string());
  return suffix == gzip_suffix ? input_suffix(path.stem()) : suffix;
}

void refuse_other_suffix(std::string_view name, std::string_view suffix) {
  for (const OtherFormat& format : other_formats) {
    std::string_view suffixes = format.suffixes;
    while (!suffixes.empty())
      if (take_first(suffixes) == suffix) {
        // Open Babel needs the format of a file whose suffix is another one.
        const bool is_misnamed = format.advice.starts_with(open_babel) && !name.starts_with('<') &&
                                 input_suffix(std::string(name)) != suffix;
        const std::string advice =
            is_misnamed ? formatted("convert it with `obabel -i{} FILE -O FILE.converted.pdb`",
                                    suffix.substr(1))
                        : std::string(format.advice);
        throw Error(formatted("{}: {} files are not read; {}", name, format.name,
                              advice_for(name, advice)));
      }
  }
}

void refuse_other_suffix(const std::filesystem::path& path) {
  refuse_other_suffix(path.string(), input_suffix(path));
}

std::string_view checked_text(std::string_view text, std::string_view name, AtomFormat format,
                              bool is_chosen) {
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  refuse_wide_characters(text, name);
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  refuse_other_suffix(name, suffix_by_content(text));
  if (is_chosen) return text;
  const AtomFormat found = structure_format_of(text);
  const bool is_kept_header = found == AtomFormat::pdb && format == AtomFormat::pqr;
  if (is_structure(found) && found != format && !is_kept_header)
    throw Error(formatted("{}: this is {} file; read it with --format {}", name,
                          found == AtomFormat::pdb ? "a PDB" : "an mmCIF",
                          found == AtomFormat::pdb ? "pdb" : "mmcif"));
  return text;
}

AtomFormat format_by_content(std::string_view text) {
  const AtomFormat by_records = format_of_records(text), by_start = structure_format_of(text);
  return by_start == AtomFormat::mmcif || by_records == AtomFormat::automatic ? by_start
                                                                              : by_records;
}

bool is_assembly_file(const std::filesystem::path& path) {
  constexpr std::string_view start = ".pdb";
  const std::string suffix = input_suffix(path);
  return suffix.starts_with(start) && suffix.size() > start.size() &&
         std::all_of(suffix.begin() + start.size(), suffix.end(), is_digit);
}

AtomFormat format_of(const std::filesystem::path& path, AtomFormat format) {
  if (format != AtomFormat::automatic) return format;
  const std::string suffix = input_suffix(path);
  if (suffix == ".pqr") return AtomFormat::pqr;
  if (suffix == ".pdb" || suffix == ".ent" || is_assembly_file(path)) return AtomFormat::pdb;
  for (const std::string_view known : {".cif", ".mmcif", ".mcif", ".pdbx"})
    if (suffix == known) return AtomFormat::mmcif;
  return AtomFormat::xyzr;
}

}  // namespace eses::detail
