// SPDX-License-Identifier: BSD-3-Clause
#include "FluentWriter.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "TestFolder.h"
#include "TestMeshes.h"

namespace pm {
namespace {

namespace fs = std::filesystem;

/// What a .msh file says, with ids from 0 and kNone for "no cell".
struct FluentText {
  struct Face {
    std::vector<Id> points;
    Id c0 = kNone, c1 = kNone;
    bool operator==(const Face& b) const { return points == b.points && c0 == b.c0 && c1 == b.c1; }
  };
  struct Zone {
    Id first = 0, last = 0;  // from 0, the last one included
    int type = 0, element = 0;
    std::string word, name;
  };
  std::vector<Vec3> points;
  std::vector<int> types;  // of cells
  std::vector<Face> faces;
  std::map<Id, Zone> cells, patches;  // by id
  std::array<Id, 3> totals{};         // nodes, cells, faces
};

/// Numbers of a section's body, from either kind of file.
class Body {
 public:
  Body(const std::string& text, std::size_t at, bool binary) : text_(text), at_(at), binary_(binary) {}
  Id id() {
    Id value = 0;
    if (binary_) {
      take(value);
    } else {
      value = static_cast<Id>(std::stol(word(), nullptr, 16));
    }
    return value;
  }
  double real() {
    double value = 0;
    if (!binary_) return std::stod(word());
    take(value);
    return value;
  }
  std::size_t at() const { return at_; }

 private:
  template <class T>
  void take(T& value) {
    std::memcpy(&value, text_.data() + at_, sizeof(T));
    at_ += sizeof(T);
  }
  std::string word() {
    const std::size_t begin = text_.find_first_not_of(" \n", at_);
    at_ = text_.find_first_of(" \n)", begin);
    return text_.substr(begin, at_ - begin);
  }
  const std::string& text_;
  std::size_t at_;
  bool binary_;
};

void readFaces(Body& body, FluentText& out, const FluentText::Zone& zone) {
  for (Id i = zone.first; i <= zone.last; ++i) {
    FluentText::Face& face = out.faces.at(i);
    face.points.resize(zone.element == 0 || zone.element == 5 ? body.id() : zone.element);
    for (Id& p : face.points) p = body.id() - 1;
    face.c0 = body.id() - 1;
    face.c1 = body.id() - 1;
  }
}

FluentText parse(const std::string& text) {
  FluentText out;
  std::size_t at = 0;
  while ((at = text.find('(', at)) != std::string::npos) {
    const int index = std::stoi(text.substr(at + 1));
    const bool binary = index >= 3000;
    const std::size_t head = text.find('(', at + 1), tail = text.find(')', at + 1);
    if (index < 10) {  // comment, header, dimension, byte order
      at = text.find('\n', at);
      continue;
    }
    std::istringstream header(text.substr(head + 1, tail - head - 1));
    FluentText::Zone zone;
    Id id = 0;
    if (index == 45) {
      header >> id >> zone.word >> zone.name;
      FluentText::Zone& known = out.cells.count(id) ? out.cells[id] : out.patches[id];
      known.word = zone.word;
      known.name = zone.name;
      at = text.find('\n', tail);
      continue;
    }
    header >> std::hex >> id >> zone.first >> zone.last >> zone.type >> zone.element;
    const int kind = index % 1000;
    if (id == 0) {
      out.totals[kind == 10 ? 0 : kind - 11] = zone.last;
      out.points.resize(out.totals[0]);
      out.types.resize(out.totals[1]);
      out.faces.resize(out.totals[2]);
      at = text.find('\n', tail);
      continue;
    }
    --zone.first, --zone.last;
    if (kind == 12) out.cells[id] = zone;
    if (kind == 13) out.patches[id] = zone;
    if (kind == 12 && zone.element != 0) {  // all of one type: no body
      std::fill(out.types.begin() + zone.first, out.types.begin() + zone.last + 1, zone.element);
      at = text.find('\n', tail);
      continue;
    }
    Body body(text, text.find('(', tail) + 1, binary);
    if (kind == 10) {
      for (Vec3& p : out.points) {
        for (double& x : p) x = body.real();
      }
    } else if (kind == 12) {
      for (Id i = zone.first; i <= zone.last; ++i) out.types.at(i) = body.id();
    } else {
      readFaces(body, out, zone);
    }
    if (binary) {
      const std::string end = ")\nEnd of Binary Section   " + std::to_string(index) + ")\n";
      EXPECT_EQ(text.substr(body.at(), end.size()), end);
    }
    at = text.find('\n', body.at());
  }
  return out;
}

class FluentWriter : public testing::FolderTest {
 protected:
  void SetUp() override {
    FolderTest::SetUp();
    fs::create_directories(folder_);
  }
  std::string file() const { return (folder_ / "a.msh").string(); }
  FluentText write(const PolyMesh& mesh, bool binary) {
    writeFluent(mesh, file(), binary, monitor_);
    return parse(read("a.msh"));
  }
};

/// Unit cubes one beside the other without touching, of the zones given.
PolyMesh looseCubes(const std::vector<Id>& zones, std::vector<std::string> names) {
  std::vector<Vec3> points;
  std::vector<testing::CellFaces> cells;
  for (std::size_t i = 0; i < zones.size(); ++i) {
    const Id p = static_cast<Id>(8 * i);
    const double x = 2.0 * static_cast<double>(i);
    for (double z : {0.0, 1.0}) {
      for (const auto& [a, b] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) points.emplace_back(x + a, b, z);
    }
    cells.push_back(testing::prism({p, p + 1, p + 2, p + 3}, {p + 4, p + 5, p + 6, p + 7}));
  }
  PolyMesh mesh = testing::joinCells(points, cells, {"wall", "main outlet"}, {"wall", "wall"},
                                     [](const testing::Face& f) { return f[0] % 8 == 4 && f[1] % 8 == 5; });
  mesh.zone = zones;
  mesh.zoneNames = std::move(names);
  return mesh;
}

/// The volume of each cell by the right-hand rule of the file's faces: their normals enter c0 and leave c1.
std::vector<double> volumes(const FluentText& text) {
  std::vector<double> out(text.types.size(), 0.0);
  for (const FluentText::Face& face : text.faces) {
    const Vec3 origin = text.points[text.faces[0].points[0]], p = text.points[face.points[0]] - origin;
    double cone = 0;
    for (std::size_t i = 1; i + 1 < face.points.size(); ++i) {
      const Vec3 a = text.points[face.points[i]] - origin, b = text.points[face.points[i + 1]] - origin;
      cone += p.dot(a.cross(b)) / 6;
    }
    out.at(face.c0) -= cone;
    if (face.c1 != kNone) out.at(face.c1) += cone;
  }
  return out;
}

TEST_F(FluentWriter, AsciiKeepsEveryBit) {
  const PolyMesh mesh = testing::hollowRoom();
  const FluentText text = write(mesh, false);
  EXPECT_EQ(text.totals,
            (std::array<Id, 3>{static_cast<Id>(mesh.points.size()), mesh.cellCount, mesh.faceCount()}));
  for (std::size_t i = 0; i < mesh.points.size(); ++i) ASSERT_EQ(text.points[i], mesh.points[i]);
  for (Id f = 0; f < mesh.internalFaces(); ++f) {
    const std::vector<Id> turned(text.faces[f].points.rbegin(), text.faces[f].points.rend());
    EXPECT_EQ(turned, std::vector<Id>(mesh.faces[f].begin(), mesh.faces[f].end()));
    EXPECT_EQ(text.faces[f].c0, mesh.owner[f]);
    EXPECT_EQ(text.faces[f].c1, mesh.neighbour[f]);
  }
}

TEST_F(FluentWriter, BinaryHoldsTheSame) {
  const PolyMesh mesh = testing::hollowRoom();
  const FluentText ascii = write(mesh, false), binary = write(mesh, true);
  EXPECT_EQ(ascii.totals, binary.totals);
  EXPECT_EQ(ascii.points, binary.points);
  EXPECT_EQ(ascii.types, binary.types);
  EXPECT_EQ(ascii.faces, binary.faces);
  ASSERT_EQ(ascii.patches.size(), binary.patches.size());
  for (const auto& [id, zone] : ascii.patches) {
    EXPECT_EQ(zone.name, binary.patches.at(id).name);
    EXPECT_EQ(zone.first, binary.patches.at(id).first);
  }
  EXPECT_NE(read("a.msh").find("(4 (60 "), std::string::npos);
}

TEST_F(FluentWriter, NormalsEnterTheFirstCell) {
  testing::VoxelOptions o;
  o.size = {2, 3, 4};
  const FluentText text = write(testing::layeredVoxels(o), true);
  double sum = 0;
  for (double volume : volumes(text)) {
    EXPECT_GT(volume, 0.03);
    sum += volume;
  }
  EXPECT_NEAR(sum, (2 + 2.0 / 3) * (3 + 2.0 / 3) * (4 + 2.0 / 3), 1e-9);
}

TEST_F(FluentWriter, ZonesAreThePatches) {
  const PolyMesh mesh = testing::hollowRoom();
  const FluentText text = write(mesh, true);
  std::map<std::string, FluentText::Zone> byName;
  Id next = 0;
  for (const auto& [id, zone] : text.patches) {
    EXPECT_EQ(zone.first, next);
    next = zone.last + 1;
    byName[zone.name] = zone;
  }
  EXPECT_EQ(next, mesh.faceCount());
  ASSERT_EQ(byName.size(), 5u);  // ymin, ymax and zmax are walls: their patches have no faces
  EXPECT_EQ(byName.at("interior-fluid").type, 2);
  EXPECT_EQ(byName.at("interior-fluid").last + 1, mesh.internalFaces());
  EXPECT_EQ(byName.at("wall").type, 3);
  EXPECT_EQ(byName.at("wall").word, "wall");
  EXPECT_EQ(byName.at("wall").last - byName.at("wall").first + 1, 6 + 3 * 9);
  for (const char* side : {"xmin", "xmax", "zmin"}) {
    EXPECT_EQ(byName.at(side).type, 5);
    EXPECT_EQ(byName.at(side).word, "pressure-outlet");
  }
  ASSERT_EQ(text.cells.size(), 1u);
  EXPECT_EQ(text.cells.begin()->second.name, "fluid");
}

TEST_F(FluentWriter, CellsOfAZoneAreConsecutive) {
  const PolyMesh mesh = looseCubes({1, 0, 1, 0, 0}, {"oil", "water side"});
  const FluentText text = write(mesh, false);
  ASSERT_EQ(text.cells.size(), 2u);
  std::vector<FluentText::Zone> zones;
  for (const auto& [id, zone] : text.cells) zones.push_back(zone);
  EXPECT_EQ(zones[0].name, "oil");
  EXPECT_EQ(zones[0].last, 2);
  EXPECT_EQ(zones[1].name, "water_side");
  EXPECT_EQ(zones[1].first, 3);
  EXPECT_EQ(zones[1].last, 4);
  for (const auto& [id, zone] : text.patches) {  // one zone of cells behind each zone of faces
    for (Id f = zone.first; f <= zone.last; ++f) {
      EXPECT_EQ(text.faces[f].c0 <= 2, text.faces[zone.first].c0 <= 2) << zone.name;
    }
  }
  std::vector<std::string> names;
  for (const auto& [id, zone] : text.patches) names.push_back(zone.name + " " + zone.word);
  const std::vector<std::string> expected{"wall-oil wall", "wall-water_side wall",
                                          "main_outlet-oil pressure-outlet",
                                          "main_outlet-water_side pressure-outlet"};
  EXPECT_EQ(names, expected);
  // Cells 1, 3, 4 of the mesh are the file's first three: their corners tell.
  for (const FluentText::Face& face : text.faces) {
    EXPECT_EQ(face.points[0] / 8, (std::array<Id, 5>{1, 3, 4, 0, 2})[face.c0]);
  }
}

TEST_F(FluentWriter, NoTwoZonesShareAName) {
  PolyMesh mesh = looseCubes({0, 1}, {"wall", "b"});
  for (Id i = 0; i < mesh.boundaryFaces(); ++i) mesh.patch[i] = mesh.owner[i];
  mesh.patchNames = {"b", "wall"};
  const FluentText text = write(mesh, false);
  std::vector<std::string> names;
  for (const auto& [id, zone] : text.cells) names.push_back(zone.name);
  for (const auto& [id, zone] : text.patches) names.push_back(zone.name);
  EXPECT_EQ(names, (std::vector<std::string>{"wall_2", "b_2", "b", "wall"}));
}

FluentCell shapeOf(const std::vector<testing::Face>& faces) {
  PolyMesh mesh;
  std::vector<Id> ids;
  for (const testing::Face& face : faces) {
    ids.push_back(mesh.faces.rows());
    mesh.faces.push(face);
  }
  return fluentCell(mesh, {ids.data(), ids.data() + ids.size()});
}

TEST(FluentCell, PlainShapes) {
  EXPECT_EQ(shapeOf({{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}), FluentCell::Tetrahedron);
  EXPECT_EQ(shapeOf({{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}), FluentCell::Pyramid);
  EXPECT_EQ(shapeOf(testing::prism({0, 1, 2}, {3, 4, 5})), FluentCell::Wedge);
  EXPECT_EQ(shapeOf(testing::prism({0, 1, 2, 3}, {4, 5, 6, 7})), FluentCell::Hexahedron);
}

TEST(FluentCell, EverythingElseIsAPolyhedron) {
  EXPECT_EQ(shapeOf(testing::prism({0, 1, 2, 3, 4}, {5, 6, 7, 8, 9})), FluentCell::Polyhedron);
  auto split = testing::prism({0, 1, 2, 3}, {4, 5, 6, 7});  // one face in two triangles
  split[0] = {0, 3, 2};
  split.push_back({0, 2, 1});
  EXPECT_EQ(shapeOf(split), FluentCell::Polyhedron);
  // Six quads with eight corners in all, but slices of a melon and no cube.
  std::vector<testing::Face> melon;
  for (Id i = 0; i < 6; ++i) melon.push_back({6, i, 7, (i + 1) % 6});
  EXPECT_EQ(shapeOf(melon), FluentCell::Polyhedron);
}

TEST_F(FluentWriter, TypesAreListedWhenTheyDiffer) {
  std::vector<std::array<double, 2>> points{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 0.5}};
  const PolyMesh mesh = testing::layeredPolygons(points, {{0, 1, 2, 3}, {1, 4, 2}}, 0.5);
  const FluentText text = write(mesh, false);
  std::vector<int> sorted = text.types;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(sorted, (std::vector<int>{4, 4, 6, 6}));
  EXPECT_EQ(text.cells.begin()->second.element, 0);
  const PolyMesh cubes = looseCubes({0, 0}, {"only"});
  EXPECT_EQ(write(cubes, true).cells.begin()->second.element, 4);
}

TEST(FluentBoundary, NamesTellWhatFlowsThrough) {
  PolyMesh mesh;
  mesh.patchNames = {"Inlet_1",    "main-outlet", "outer wall", "xmin",
                     "myFarField", "inflow",      "opening",    "far"};
  mesh.patchTypes = {"wall", "wall", "wall", "patch", "wall", "patch", "wall", "patch"};
  std::vector<std::string> words;
  for (Id patch = 0; patch < 8; ++patch) words.push_back(fluentBoundary(mesh, patch).word);
  EXPECT_EQ(words, (std::vector<std::string>{"velocity-inlet", "pressure-outlet", "wall", "pressure-outlet",
                                             "pressure-far-field", "velocity-inlet", "pressure-outlet",
                                             "pressure-far-field"}));
  EXPECT_EQ(fluentBoundary(mesh, 0).type, 10);
  EXPECT_EQ(fluentBoundary(mesh, 2).type, 3);
}

TEST_F(FluentWriter, FolderThatIsNotThereIsAnInputError) {
  try {
    writeFluent(testing::hollowRoom(), (folder_ / "none" / "a.msh").string(), true, monitor_);
    FAIL() << "no error";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("none/a.msh"), std::string::npos);
  }
}

TEST_F(FluentWriter, FullDiskKeepsTheOldFile) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "needs /dev/full";
  std::ofstream(file()) << "old";
  fs::create_symlink("/dev/full", file() + ".part");
  for (bool binary : {false, true}) {
    EXPECT_THROW(writeFluent(testing::hollowRoom(), file(), binary, monitor_), InputError);
    EXPECT_EQ(read("a.msh"), "old");
    EXPECT_FALSE(fs::exists(fs::symlink_status(file() + ".part")));
    fs::create_symlink("/dev/full", file() + ".part");
  }
}

TEST_F(FluentWriter, AbortLeavesNothingHalfMade) {
  struct Stop : Monitor {
    int calls = 0;
    bool aborted() const override { return calls > 3; }
    void progress(double, const std::string&) override { ++calls; }
  } stop;
  EXPECT_THROW(writeFluent(testing::hollowRoom(), file(), false, stop), AbortError);
  EXPECT_TRUE(fs::is_empty(folder_));
}

}  // namespace
}  // namespace pm
