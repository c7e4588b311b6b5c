#include "support/mesh_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "eses/read_atoms.hpp"
#include "support/eses_files.hpp"

namespace eses::detail::test {
namespace {

void require(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(what);
}

// --- PLY ----------------------------------------------------------------------------------------

struct Property {
  std::string type, name;
};

struct PlyHeader {
  std::size_t vertices = 0, faces = 0, bytes = 0;
  bool is_ascii = false;
  std::vector<Property> properties;  // properties of vertices
  std::vector<std::string> comments;
};

PlyHeader read_ply_header(const std::string& bytes) {
  PlyHeader header;
  const std::string end = "end_header\n";
  header.bytes = bytes.find(end);
  require(header.bytes != std::string::npos, "PLY: no end of the header");
  std::istringstream lines(bytes.substr(0, header.bytes));
  header.bytes += end.size();
  std::string line, element;
  std::getline(lines, line);
  require(line == "ply", "PLY: not the magic number");
  std::getline(lines, line);
  header.is_ascii = line == "format ascii 1.0";
  require(header.is_ascii || line == "format binary_little_endian 1.0",
          "PLY: not the format expected");
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (keyword == "comment") {
      header.comments.push_back(line.substr(8));
    } else if (keyword == "element") {
      std::size_t count = 0;
      words >> element >> count;
      require(element == "vertex" || element == "face", "PLY: an element that is not known");
      (element == "vertex" ? header.vertices : header.faces) = count;
    } else {
      require(keyword == "property", "PLY: a line that is not known");
      Property property;
      words >> property.type >> property.name;
      if (element == "vertex") header.properties.push_back(property);
      if (element == "face")
        require(line == "property list uchar int vertex_indices", "PLY: other faces");
    }
  }
  return header;
}

class Bytes {
 public:
  explicit Bytes(const std::string& text) : rest_(text.data()), end_(rest_ + text.size()) {}
  template <class Value>
  Value take() {
    require(static_cast<std::size_t>(end_ - rest_) >= sizeof(Value), "PLY: the file is too short");
    Value value;
    std::memcpy(&value, rest_, sizeof value);
    rest_ += sizeof value;
    return value;
  }
  void skip(std::size_t bytes) { rest_ += bytes; }
  bool is_at_end() const { return rest_ == end_; }

 private:
  const char* rest_;
  const char* end_;
};

double take_number(Bytes& bytes, const std::string& type) {
  if (type == "double") return bytes.take<double>();
  if (type == "float") return bytes.take<float>();
  if (type == "uchar") return bytes.take<std::uint8_t>();
  require(type == "uint", "PLY: a type that is not known");
  return bytes.take<std::uint32_t>();
}

void add_vertex(const std::map<std::string, double>& values, Mesh& mesh) {
  mesh.positions.push_back({values.at("x"), values.at("y"), values.at("z")});
  mesh.normals.push_back({values.at("nx"), values.at("ny"), values.at("nz")});
  mesh.patches.push_back(static_cast<int>(values.at("patch")));
  mesh.atoms.push_back(static_cast<std::uint32_t>(values.at("atom")));
  if (values.contains("red"))
    mesh.colors.push_back({static_cast<int>(values.at("red")), static_cast<int>(values.at("green")),
                           static_cast<int>(values.at("blue"))});
  if (values.contains("potential")) mesh.potentials.push_back(values.at("potential"));
  if (values.contains("component"))
    mesh.components.push_back(static_cast<std::uint32_t>(values.at("component")));
  if (!values.contains("chain")) return;
  mesh.chains.push_back(static_cast<std::uint32_t>(values.at("chain")));
  mesh.residues.push_back(static_cast<std::uint32_t>(values.at("residue")));
}

void read_ascii_ply(const std::string& text, const PlyHeader& header, Mesh& mesh) {
  std::istringstream lines(text.substr(header.bytes));
  std::string line;
  for (std::size_t v = 0; v < header.vertices; ++v) {
    require(!std::getline(lines, line).fail(), "PLY: a vertex is missing");
    std::istringstream words(line);
    std::map<std::string, double> values;
    for (const Property& property : header.properties) words >> values[property.name];
    require(!words.fail() && (words >> std::ws).eof(), "PLY: a vertex that is not as the header");
    add_vertex(values, mesh);
  }
  for (std::size_t f = 0; f < header.faces; ++f) {
    int corners = 0;
    MeshTriangle& triangle = mesh.triangles.emplace_back();
    lines >> corners >> triangle[0] >> triangle[1] >> triangle[2];
    require(!lines.fail() && corners == 3, "PLY: a face that is no triangle");
  }
  require((lines >> std::ws).eof(), "PLY: the file is too long");
}

Mesh read_ply(const std::string& text) {
  const PlyHeader header = read_ply_header(text);
  Mesh mesh;
  mesh.comments = header.comments;
  if (header.is_ascii) {
    read_ascii_ply(text, header, mesh);
    return mesh;
  }
  Bytes bytes(text);
  bytes.skip(header.bytes);
  for (std::size_t v = 0; v < header.vertices; ++v) {
    std::map<std::string, double> values;
    for (const Property& property : header.properties)
      values[property.name] = take_number(bytes, property.type);
    add_vertex(values, mesh);
  }
  for (std::size_t f = 0; f < header.faces; ++f) {
    require(bytes.take<std::uint8_t>() == 3, "PLY: a face that is no triangle");
    MeshTriangle& triangle = mesh.triangles.emplace_back();
    for (std::uint64_t& vertex : triangle)
      vertex = static_cast<std::uint64_t>(bytes.take<std::int32_t>());
  }
  require(bytes.is_at_end(), "PLY: the file is too long");
  return mesh;
}

// --- text ---------------------------------------------------------------------------------------

Vec3 take_vector(std::istream& words) {
  Vec3 vector;
  words >> vector.x >> vector.y >> vector.z;
  require(!words.fail(), "three numbers expected");
  return vector;
}

Mesh read_obj(const std::string& text) {
  Mesh mesh;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (keyword == "v") {
      mesh.positions.push_back(take_vector(words));
      if (Vec3 color; words >> color.x >> color.y >> color.z)
        mesh.colors.push_back({static_cast<int>(std::lround(255 * color.x)),
                               static_cast<int>(std::lround(255 * color.y)),
                               static_cast<int>(std::lround(255 * color.z))});
    }
    if (keyword == "vn") mesh.normals.push_back(take_vector(words));
    if (keyword != "f") continue;
    MeshTriangle& triangle = mesh.triangles.emplace_back();
    for (std::uint64_t& vertex : triangle) {
      std::uint64_t normal = 0;
      char slashes[2] = {};
      words >> vertex >> slashes[0] >> slashes[1] >> normal;
      require(
          !words.fail() && slashes[0] == '/' && slashes[1] == '/' && normal == vertex && vertex > 0,
          "OBJ: a face that is not as expected");
      --vertex;
    }
  }
  return mesh;
}

/// Numbers in little-endian order.
class BinaryReader {
 public:
  explicit BinaryReader(const std::string& bytes) : bytes_(bytes) {}

  std::size_t offset() const { return offset_; }
  void skip(std::size_t bytes) { offset_ += bytes; }

  template <class Value>
  Value take() {
    static_assert(std::endian::native == std::endian::little);
    require(offset_ + sizeof(Value) <= bytes_.size(), "a binary file that is too short");
    Value value;
    std::memcpy(&value, bytes_.data() + offset_, sizeof value);
    offset_ += sizeof value;
    return value;
  }

  Vec3 take_vector() {
    const auto x = take<float>(), y = take<float>(), z = take<float>();
    return {x, y, z};
  }

 private:
  const std::string& bytes_;
  std::size_t offset_ = 0;
};

/// `normals` are those of the triangles, and each triangle has its own vertices.
Mesh read_stl(const std::string& bytes) {
  Mesh mesh;
  BinaryReader reader(bytes);
  reader.skip(80);
  const auto count = reader.take<std::uint32_t>();
  for (std::uint64_t i = 0; i < count; ++i) {
    mesh.normals.push_back(reader.take_vector());
    for (int corner = 0; corner < 3; ++corner) mesh.positions.push_back(reader.take_vector());
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    reader.take<std::uint16_t>();
  }
  require(reader.offset() == bytes.size() && !bytes.starts_with("solid"), "STL: the length");
  return mesh;
}

/// The numbers after each occurrence of a key in JSON.
std::vector<double> numbers_after(const std::string& json, const std::string& key) {
  std::vector<double> numbers;
  for (std::size_t at = json.find(key); at != std::string::npos; at = json.find(key, at + 1)) {
    std::istringstream words(json.substr(at + key.size()));
    char separator = words.peek() == '[' ? static_cast<char>(words.get()) : ' ';
    do {
      words >> numbers.emplace_back() >> separator;
    } while (separator == ',' && words.peek() != '"');
  }
  return numbers;
}

/// glTF with the layout of our files.
Mesh read_glb(const std::string& bytes) {
  BinaryReader reader(bytes);
  require(reader.take<std::uint32_t>() == 0x46546C67 && reader.take<std::uint32_t>() == 2 &&
              reader.take<std::uint32_t>() == bytes.size(),
          "GLB: the header");
  const auto json_bytes = reader.take<std::uint32_t>();
  require(reader.take<std::uint32_t>() == 0x4E4F534A && json_bytes % 4 == 0, "GLB: the JSON chunk");
  const std::string json = bytes.substr(reader.offset(), json_bytes);
  reader.skip(json_bytes);
  const auto data_bytes = reader.take<std::uint32_t>();
  require(
      reader.take<std::uint32_t>() == 0x004E4942 && reader.offset() + data_bytes == bytes.size(),
      "GLB: the binary chunk");
  Mesh mesh;
  const std::vector<double> counts = numbers_after(json, "\"count\":");
  if (counts.empty()) return mesh;
  const std::vector<double> translation = numbers_after(json, "\"translation\":");
  const bool has_colors = json.find("COLOR_0") != std::string::npos;
  Vec3 low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
  for (double i = 0; i < counts[0]; ++i) {
    const Vec3 position = reader.take_vector();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], position[axis]);
      high[axis] = std::max(high[axis], position[axis]);
    }
    mesh.positions.push_back(position + Vec3{translation[0], translation[1], translation[2]});
    mesh.normals.push_back(reader.take_vector());
    if (!has_colors) continue;
    std::array<int, 3> color{};
    for (int& part : color) part = reader.take<std::uint8_t>();
    mesh.colors.push_back(color);
    require(reader.take<std::uint8_t>() == 255, "GLB: a transparent vertex");
  }
  require(numbers_after(json, "\"min\":") == std::vector{low.x, low.y, low.z} &&
              numbers_after(json, "\"max\":") == std::vector{high.x, high.y, high.z},
          "GLB: the bounding box");
  for (double i = 0; i < counts.back(); i += 3) {
    const auto a = reader.take<std::uint32_t>(), b = reader.take<std::uint32_t>(),
               c = reader.take<std::uint32_t>();
    mesh.triangles.push_back({a, b, c});
  }
  require(reader.offset() == bytes.size(), "GLB: the length of the data");
  return mesh;
}

Mesh read_off(const std::string& text) {
  Mesh mesh;
  std::istringstream words(text);
  std::string magic;
  std::size_t vertices = 0, faces = 0, edges = 0;
  words >> magic >> vertices >> faces >> edges;
  require(magic == "OFF" && !words.fail(), "OFF: not the header expected");
  for (std::size_t v = 0; v < vertices; ++v) mesh.positions.push_back(take_vector(words));
  for (std::size_t f = 0; f < faces; ++f) {
    int corners = 0;
    MeshTriangle& triangle = mesh.triangles.emplace_back();
    words >> corners >> triangle[0] >> triangle[1] >> triangle[2];
    require(!words.fail() && corners == 3, "OFF: a face that is no triangle");
  }
  words >> magic;
  require(words.fail(), "OFF: the file is too long");
  return mesh;
}

// --- MSMS ---------------------------------------------------------------------------------------

// The words of the lines after the three header lines, with a fixed number of words each.
std::vector<std::vector<std::string>> msms_lines(const std::filesystem::path& path,
                                                 std::size_t columns, std::string& header) {
  std::istringstream lines(read_bytes(path));
  std::string line;
  for (int i = 0; i < 2; ++i) {
    std::getline(lines, line);
    require(line.starts_with('#'), "MSMS: not a comment");
  }
  std::getline(lines, header);
  std::vector<std::vector<std::string>> result;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    auto& row = result.emplace_back();
    for (std::string word; words >> word;) row.push_back(word);
    require(row.size() == columns, "MSMS: another number of columns");
  }
  return result;
}

int patch_of_msms(const std::string& type) {
  require(type == "1" || type == "2" || type == "3", "MSMS: a type that is not known");
  return type == "3" ? 1 : type == "1" ? 2 : 3;
}

Mesh read_msms(std::filesystem::path path) {
  Mesh mesh;
  std::string header;
  for (const auto& row : msms_lines(path, 9, header)) {
    const auto number = [&](std::size_t i) { return std::stod(row[i]); };
    mesh.positions.push_back({number(0), number(1), number(2)});
    mesh.normals.push_back({number(3), number(4), number(5)});
    require(row[6] == "0", "MSMS: a number of an analytical face");
    mesh.atoms.push_back(static_cast<std::uint32_t>(std::stoul(row[7]) - 1));
    mesh.patches.push_back(patch_of_msms(row[8]));
  }
  std::istringstream words(header);
  for (double& value : mesh.msms_header) words >> value;
  require(!words.fail() && mesh.msms_header[0] == static_cast<double>(mesh.positions.size()),
          "MSMS: another number of vertices");
  for (const auto& row : msms_lines(path.replace_extension(".face"), 5, header)) {
    MeshTriangle& triangle = mesh.triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) triangle[i] = std::stoull(row[i]) - 1;
    mesh.triangle_patches.push_back(patch_of_msms(row[3]));
    require(row[4] == "0", "MSMS: a number of an analytical face");
  }
  require(std::stoull(header) == mesh.triangles.size(), "MSMS: another number of triangles");
  return mesh;
}

// --- VTP ----------------------------------------------------------------------------------------

std::string attribute_in(const std::string& element, const std::string& name) {
  const std::string begin = " " + name + "=\"";
  const std::size_t at = element.find(begin);
  require(at != std::string::npos, "VTP: an attribute is missing");
  const std::size_t value = at + begin.size();
  return element.substr(value, element.find('"', value) - value);
}

class VtpFile {
 public:
  explicit VtpFile(const std::string& text) : text_(text) {
    const std::string begin = "<AppendedData encoding=\"raw\">\n_";
    data_ = text.find(begin);
    require(data_ != std::string::npos, "VTP: no data");
    data_ += begin.size();
    require(text.starts_with("<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\""), "VTP: no XML");
    require(text.ends_with("\n</AppendedData>\n</VTKFile>\n"), "VTP: no end");
  }

  std::size_t count(const std::string& name) const {
    return std::stoull(attribute_in(element("<Piece "), name));
  }
  bool has(const std::string& name) const { return text_.find(" Name=\"" + name + "\"") < data_; }

  template <class Value>
  std::vector<Value> values(const std::string& name, const char* type) const {
    const std::string array = array_of(name);
    require(attribute_in(array, "type") == type, "VTP: another type");
    require(attribute_in(array, "format") == "appended", "VTP: not appended");
    const std::size_t begin = data_ + std::stoull(attribute_in(array, "offset"));
    std::uint64_t bytes = 0;
    require(begin + sizeof bytes <= text_.size(), "VTP: an array behind the end");
    std::memcpy(&bytes, text_.data() + begin, sizeof bytes);
    require(bytes % sizeof(Value) == 0 && begin + sizeof bytes + bytes <= text_.size(),
            "VTP: an array that is too long");
    std::vector<Value> result(bytes / sizeof(Value));
    if (bytes > 0) std::memcpy(result.data(), text_.data() + begin + sizeof bytes, bytes);
    return result;
  }

  std::vector<std::string> names(const std::string& name) const {
    const std::string array = array_of(name);
    require(attribute_in(array, "type") == "String", "VTP: not an array of strings");
    const std::size_t begin = text_.find(array) + array.size();
    std::istringstream codes(text_.substr(begin, text_.find('<', begin) - begin));
    std::vector<std::string> result;
    std::string text;
    for (int code = 0; codes >> code;) {
      if (code != 0) {
        text.push_back(static_cast<char>(code));
        continue;
      }
      result.push_back(text);
      text.clear();
    }
    require(result.size() == std::stoull(attribute_in(array, "NumberOfTuples")),
            "VTP: another number of strings");
    return result;
  }

 private:
  std::string element(const std::string& begin) const {
    const std::size_t at = text_.find(begin);
    require(at < data_, "VTP: an element is missing");
    return text_.substr(at, text_.find('>', at) + 1 - at);
  }
  std::string array_of(const std::string& name) const {
    const std::size_t at = text_.find(" Name=\"" + name + "\"");
    require(at < data_, "VTP: an array is missing");
    const std::size_t begin = text_.rfind('<', at);
    return text_.substr(begin, text_.find('>', at) + 1 - begin);
  }

  const std::string& text_;
  std::size_t data_ = 0;
};

template <class Value>
std::vector<Vec3> vectors_of(const std::vector<Value>& values) {
  std::vector<Vec3> result;
  for (std::size_t i = 0; i + 2 < values.size(); i += 3)
    result.push_back({values[i], values[i + 1], values[i + 2]});
  return result;
}

Mesh read_vtp(const std::string& text) {
  const VtpFile file(text);
  Mesh mesh;
  mesh.positions = vectors_of(file.values<double>("Points", "Float64"));
  mesh.normals = vectors_of(file.values<float>("Normals", "Float32"));
  for (const std::uint8_t patch : file.values<std::uint8_t>("patch", "UInt8"))
    mesh.patches.push_back(patch);
  mesh.atoms = file.values<std::uint32_t>("atom", "UInt32");
  if (file.has("color")) {
    const auto channels = file.values<std::uint8_t>("color", "UInt8");
    for (std::size_t i = 0; i + 2 < channels.size(); i += 3)
      mesh.colors.push_back({channels[i], channels[i + 1], channels[i + 2]});
  }
  if (file.has("chain")) {
    mesh.chains = file.values<std::uint32_t>("chain", "UInt32");
    mesh.residues = file.values<std::uint32_t>("residue", "UInt32");
    mesh.chain_names = file.names("chain_name");
    mesh.residue_names = file.names("residue_name");
  }
  if (file.has("component")) mesh.components = file.values<std::uint32_t>("component", "UInt32");
  if (file.has("potential"))
    for (const float potential : file.values<float>("potential", "Float32"))
      mesh.potentials.push_back(potential);
  const auto corners = file.values<std::int32_t>("connectivity", "Int32");
  const auto ends = file.values<std::int64_t>("offsets", "Int64");
  require(corners.size() == 3 * ends.size(), "VTP: cells that are no triangles");
  for (std::size_t i = 0; i < ends.size(); ++i) {
    require(ends[i] == static_cast<std::int64_t>(3 * (i + 1)), "VTP: a cell that is no triangle");
    MeshTriangle& triangle = mesh.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      triangle[k] = static_cast<std::uint64_t>(corners[3 * i + k]);
  }
  require(file.count("NumberOfPoints") == mesh.positions.size() &&
              file.count("NumberOfPolys") == mesh.triangles.size() &&
              mesh.normals.size() == mesh.positions.size() &&
              mesh.patches.size() == mesh.positions.size() &&
              mesh.atoms.size() == mesh.positions.size(),
          "VTP: counts that differ");
  return mesh;
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& path) {
  if (path.extension() == ".vert") return read_msms(path);
  const std::string text = read_bytes(path);
  if (path.extension() == ".vtp") return read_vtp(text);
  if (path.extension() == ".ply") return read_ply(text);
  if (path.extension() == ".obj") return read_obj(text);
  if (path.extension() == ".stl") return read_stl(text);
  if (path.extension() == ".glb") return read_glb(text);
  require(path.extension() == ".off", "no format has this suffix");
  return read_off(text);
}

Molecule make_two_chains() {
  const AtomFile file = parse_atoms(
      "ATOM 1 N ALA B 52A 0.0 0.0 0.0 0.0 1.5\n"
      "ATOM 2 C ALA B 52A 1.5 0.0 0.0 0.0 1.7\n"
      "ATOM 3 N GLY A 1 6.0 0.0 0.0 0.0 1.5\n"
      "ATOM 4 N GLY B 53 9.5 0.0 0.0 0.0 1.5\n",
      AtomFormat::pqr, "t.pqr");
  return {file.atoms, file.labels};
}

}  // namespace eses::detail::test
