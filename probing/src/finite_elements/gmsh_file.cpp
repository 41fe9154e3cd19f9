// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>

#include "finite_elements/finite_element_tools.h"
#include "palpate/core/error.h"
#include "palpate/probing/finite_element_mesh.h"

namespace palpate::probing {
namespace {

constexpr int kLinearTetrahedron = 4, kQuadraticTetrahedron = 11;  // Gmsh's types of elements
// Gmsh's order of the nodes of a quadratic tetrahedron, in ours.
constexpr std::array<int, 10> kGmshNodes{0, 1, 2, 3, 4, 5, 6, 7, 9, 8};

struct GmshElement {
  int type = 0;
  int region = 0;
  std::vector<long> nodes;  // tags
};

class GmshReader {
 public:
  explicit GmshReader(const std::filesystem::path& path) : name_(path.string()), file_(path) {
    if (!file_) throw FileError(name_ + ": cannot be read; pass a Gmsh file (.msh)");
  }

  FiniteElementMesh read() {
    std::string section;
    bool has_format = false;
    while (next_line(section)) {
      if (section.empty() || section[0] != '$' || section.rfind("$End", 0) == 0) continue;
      if (section == "$MeshFormat") {
        read_format();
        has_format = true;
        continue;
      }
      if (!has_format) fail("is not a Gmsh file: it must begin with $MeshFormat");
      if (section == "$Entities") {
        read_entities();
      } else if (section == "$Nodes") {
        old_ ? read_old_nodes() : read_nodes();
      } else if (section == "$Elements") {
        old_ ? read_old_elements() : read_elements();
      } else {
        const std::string end = "$End" + section.substr(1);
        std::string line;
        while (line != end)
          if (!next_line(line)) fail("ends inside " + section + "; save it again");
      }
    }
    return mesh();
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw FileError(name_ + ": line " + std::to_string(line_) + ": " + what);
  }

  bool next_line(std::string& line) {
    if (!std::getline(file_, line)) return false;
    ++line_;
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    return true;
  }

  // The numbers of the next line, at least `count`.
  template <typename Number>
  std::vector<Number> numbers(std::size_t count, const char* what) {
    std::string line;
    if (!next_line(line)) fail(std::string("the file ends where ") + what + " should be");
    std::istringstream text(line);
    std::vector<Number> result;
    Number number{};
    while (text >> number) result.push_back(number);
    if (result.size() < count || !text.eof())
      fail("'" + line + "' must be " + std::to_string(count) + " or more numbers: " + what);
    return result;
  }

  long count(long number, const char* what) {
    constexpr long kMost = 100'000'000;
    if (number < 0 || number > kMost)
      fail("there are " + std::to_string(number) + " " + what + "; the file seems to be damaged");
    return number;
  }

  void read_format() {
    const auto format = numbers<double>(3, "version, file type and data size");
    constexpr double kOld = 2.2, kNew = 4.1;
    if (format[0] != kOld && format[0] != kNew) {
      std::ostringstream version;
      version << format[0];
      fail("version " + version.str() + " is not read; save it as 2.2 or 4.1");
    }
    if (format[1] != 0) fail("binary files are not read; save it as ASCII");
    old_ = format[0] == kOld;
  }

  // Version 4.1: the physical groups of volumes.
  void read_entities() {
    const auto sizes = numbers<long>(4, "numbers of points, curves, surfaces and volumes");
    for (int dimension = 0; dimension < 4; ++dimension) {
      const long entities = count(sizes[static_cast<std::size_t>(dimension)], "entities");
      for (long i = 0; i < entities; ++i) {
        const std::size_t box = dimension == 0 ? 3 : 6;  // coordinates after the tag
        const auto line = numbers<double>(box + 2, "tag, extent and physical groups");
        if (dimension == 3 && line[box + 1] > 0 && line.size() > box + 2)
          groups_[static_cast<long>(line[0])] = static_cast<int>(line[box + 2]);
      }
    }
  }

  void add_node(long tag, double x, double y, double z) {
    if (!places_.try_emplace(tag, x, y, z).second)
      fail("node " + std::to_string(tag) + " is there twice");
  }

  void read_old_nodes() {
    const long nodes = count(numbers<long>(1, "number of nodes")[0], "nodes");
    for (long i = 0; i < nodes; ++i) {
      const auto line = numbers<double>(4, "tag and coordinates of a node");
      add_node(static_cast<long>(line[0]), line[1], line[2], line[3]);
    }
  }

  void read_nodes() {
    const auto head = numbers<long>(4, "numbers of blocks and nodes");
    for (long block = 0; block < count(head[0], "blocks of nodes"); ++block) {
      const auto entity = numbers<long>(4, "dimension, tag, parametric, number of nodes");
      std::vector<long> tags;
      for (long i = 0; i < count(entity[3], "nodes"); ++i)
        tags.push_back(numbers<long>(1, "tag of a node")[0]);
      for (const long tag : tags) {
        const auto at = numbers<double>(3, "coordinates of a node");
        add_node(tag, at[0], at[1], at[2]);
      }
    }
  }

  void add_element(long type, int region, const std::vector<long>& line, std::size_t first) {
    if (type != kLinearTetrahedron && type != kQuadraticTetrahedron) return;
    const std::size_t nodes = type == kLinearTetrahedron ? 4 : 10;
    if (line.size() != first + nodes)
      fail("a tetrahedron of type " + std::to_string(type) + " must have " + std::to_string(nodes) +
           " nodes");
    if (!elements_.empty() && elements_.front().type != type)
      fail("linear and quadratic tetrahedra are mixed; mesh all of one order");
    GmshElement element{static_cast<int>(type), region, {}};
    for (std::size_t k = first; k < line.size(); ++k) {
      if (!places_.contains(line[k]))
        fail("node " + std::to_string(line[k]) + " of an element is not among the nodes");
      element.nodes.push_back(line[k]);
    }
    elements_.push_back(std::move(element));
  }

  void read_old_elements() {
    const long elements = count(numbers<long>(1, "number of elements")[0], "elements");
    for (long i = 0; i < elements; ++i) {
      const auto line = numbers<long>(3, "tag, type, number of tags, tags and nodes");
      const auto tags = static_cast<std::size_t>(count(line[2], "tags"));
      if (line.size() < 3 + tags) fail("there are fewer tags than announced");
      add_element(line[1], tags > 0 ? static_cast<int>(line[3]) : 0, line, 3 + tags);
    }
  }

  void read_elements() {
    const auto head = numbers<long>(4, "numbers of blocks and elements");
    for (long block = 0; block < count(head[0], "blocks of elements"); ++block) {
      const auto entity = numbers<long>(4, "dimension, tag, type, number of elements");
      const auto group = groups_.find(entity[1]);
      const int region = entity[0] == 3 && group != groups_.end() ? group->second : 0;
      for (long i = 0; i < count(entity[3], "elements"); ++i)
        add_element(entity[2], region, numbers<long>(2, "tag and nodes of an element"), 1);
    }
  }

  FiniteElementMesh mesh() const {
    if (elements_.empty())
      throw FileError(name_ + ": has no tetrahedra; mesh the volume, not only its surface");
    std::map<long, int> index;
    for (const GmshElement& element : elements_)
      for (const long tag : element.nodes) index.try_emplace(tag, 0);
    Eigen::Matrix3Xd nodes(3, static_cast<Eigen::Index>(index.size()));
    int next = 0;
    for (auto& [tag, node] : index) {
      node = next++;
      nodes.col(node) = places_.at(tag);
    }
    const auto node_of = [&](const GmshElement& element, int k) {
      return index.at(element.nodes[static_cast<std::size_t>(k)]);
    };
    FiniteElementMesh result;
    if (elements_.front().type == kLinearTetrahedron) {
      std::vector<std::array<int, 4>> corners;
      for (const GmshElement& element : elements_)
        corners.push_back(
            {node_of(element, 0), node_of(element, 1), node_of(element, 2), node_of(element, 3)});
      result = with_middle_nodes(nodes, corners);
    } else {
      result.nodes = nodes;
      result.elements.resize(10, static_cast<Eigen::Index>(elements_.size()));
      for (std::size_t e = 0; e < elements_.size(); ++e)
        for (int k = 0; k < 10; ++k)
          result.elements(kGmshNodes[static_cast<std::size_t>(k)], static_cast<Eigen::Index>(e)) =
              node_of(elements_[e], k);
    }
    result.regions.clear();
    for (const GmshElement& element : elements_) result.regions.push_back(element.region);
    return result;
  }

  std::string name_;
  std::ifstream file_;
  long line_ = 0;
  bool old_ = false;
  std::map<long, Eigen::Vector3d> places_;
  std::map<long, int> groups_;
  std::vector<GmshElement> elements_;
};

}  // namespace

FiniteElementMesh read_gmsh(const std::filesystem::path& path) { return GmshReader(path).read(); }

}  // namespace palpate::probing
