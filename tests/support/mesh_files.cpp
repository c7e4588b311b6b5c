#include "support/mesh_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

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
  std::vector<Property> properties;  // of vertices
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
  require(line == "format binary_little_endian 1.0", "PLY: not the format expected");
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

void take_vertex(Bytes& bytes, const std::vector<Property>& properties, Mesh& mesh) {
  std::map<std::string, double> values;
  for (const Property& property : properties)
    values[property.name] = take_number(bytes, property.type);
  mesh.positions.push_back({values.at("x"), values.at("y"), values.at("z")});
  mesh.normals.push_back({values.at("nx"), values.at("ny"), values.at("nz")});
  mesh.patches.push_back(static_cast<int>(values.at("patch")));
  mesh.atoms.push_back(static_cast<std::uint32_t>(values.at("atom")));
  if (values.contains("red"))
    mesh.colors.push_back({static_cast<int>(values.at("red")), static_cast<int>(values.at("green")),
                           static_cast<int>(values.at("blue"))});
  if (!values.contains("chain")) return;
  mesh.chains.push_back(static_cast<std::uint32_t>(values.at("chain")));
  mesh.residues.push_back(static_cast<std::uint32_t>(values.at("residue")));
}

Mesh read_ply(const std::string& text) {
  const PlyHeader header = read_ply_header(text);
  Mesh mesh;
  mesh.comments = header.comments;
  Bytes bytes(text);
  bytes.skip(header.bytes);
  for (std::size_t v = 0; v < header.vertices; ++v) take_vertex(bytes, header.properties, mesh);
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
    if (keyword == "v") mesh.positions.push_back(take_vector(words));
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

// --- shape --------------------------------------------------------------------------------------

using DirectedEdge = std::pair<std::uint64_t, std::uint64_t>;

// Of each triangle at a vertex, the edge opposite to it: the fan's rim.
using Rim = std::map<std::uint64_t, std::uint64_t>;

bool is_one_ring(const Rim& rim) {
  if (rim.empty()) return false;
  std::size_t steps = 0;
  std::uint64_t at = rim.begin()->first;
  do {
    const auto next = rim.find(at);
    if (next == rim.end()) return false;
    at = next->second;
    ++steps;
  } while (at != rim.begin()->first && steps <= rim.size());
  return steps == rim.size();
}

std::size_t count_components(const Mesh& mesh) {
  std::vector<std::size_t> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const MeshTriangle& t : mesh.triangles)
    for (const std::uint64_t v : t) parent[root(v)] = root(t[0]);
  std::size_t count = 0;
  for (std::size_t v = 0; v < parent.size(); ++v) count += parent[v] == v;
  return count;
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& path) {
  const std::string text = read_bytes(path);
  if (path.extension() == ".ply") return read_ply(text);
  if (path.extension() == ".obj") return read_obj(text);
  require(path.extension() == ".off", "no format has this suffix");
  return read_off(text);
}

std::vector<std::string> find_mesh_faults(std::size_t vertices,
                                          std::span<const MeshTriangle> triangles) {
  std::vector<std::string> faults;
  std::map<DirectedEdge, int> edges;
  std::set<MeshTriangle> seen;
  std::vector<Rim> rims(vertices);
  for (const MeshTriangle& t : triangles) {
    MeshTriangle sorted = t;
    std::sort(sorted.begin(), sorted.end());
    if (sorted[2] >= vertices) return {"a triangle has a vertex that is not there"};
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2])
      faults.push_back(fmt::format("triangle {} {} {} has a vertex twice", t[0], t[1], t[2]));
    if (!seen.insert(sorted).second)
      faults.push_back(fmt::format("triangle {} {} {} is there twice", t[0], t[1], t[2]));
    for (std::size_t i = 0; i < 3; ++i) {
      ++edges[{t[i], t[(i + 1) % 3]}];
      rims[t[i]][t[(i + 1) % 3]] = t[(i + 2) % 3];
    }
  }
  for (const auto& [edge, count] : edges) {
    const auto opposite = edges.find({edge.second, edge.first});
    if (count != 1 || opposite == edges.end())
      faults.push_back(fmt::format("edge {} {}: {} triangles, {} on its other side", edge.first,
                                   edge.second, count,
                                   opposite == edges.end() ? 0 : opposite->second));
  }
  for (std::size_t v = 0; v < vertices; ++v)
    if (!is_one_ring(rims[v])) faults.push_back(fmt::format("vertex {}: not one fan", v));
  return faults;
}

MeshMeasures measure(const Mesh& mesh) {
  MeshMeasures result;
  std::set<DirectedEdge> edges;
  for (const MeshTriangle& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    const double area = 0.5 * norm(cross(b - a, c - a));
    if (result.area == 0 || area < result.min_area) result.min_area = area;
    result.area += area;
    const Vec3 origin = mesh.positions[0];  // so that little cancels
    result.volume += dot(a - origin, cross(b - origin, c - origin)) / 6;
    for (std::size_t i = 0; i < 3; ++i) edges.insert(std::minmax({t[i], t[(i + 1) % 3]}));
  }
  result.euler_number =
      static_cast<std::int64_t>(mesh.positions.size() + mesh.triangles.size() - edges.size());
  result.components = count_components(mesh);
  return result;
}

}  // namespace eses::detail::test
