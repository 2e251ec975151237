// SPDX-License-Identifier: BSD-3-Clause
#include "StlWriter.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "TestFolder.h"
#include "TestMeshes.h"

namespace pm {
namespace {

namespace fs = std::filesystem;

class StlWriter : public testing::FolderTest {
 protected:
  void SetUp() override {
    FolderTest::SetUp();
    fs::create_directories(folder_);
  }
  std::string file() const { return (folder_ / "a.stl").string(); }

  /// Triangles as runs of three corners, by the name of their solid.
  std::map<std::string, std::vector<Vec3>> write(const PolygonSurface& surface) {
    writeStl(surface, file(), monitor_);
    std::map<std::string, std::vector<Vec3>> solids;
    std::ifstream in(file());
    std::string name;
    for (std::string line, word; std::getline(in, line);) {
      std::istringstream words(line);
      words >> word;
      if (word == "solid") name = line.substr(6);
      if (word != "vertex") continue;
      Vec3 p;
      words >> p.x() >> p.y() >> p.z();
      solids[name].push_back(p);
    }
    return solids;
  }
};

/// The boundary of a mesh.
PolygonSurface boundaryOf(const PolyMesh& mesh) {
  PolygonSurface surface;
  surface.points = mesh.points;
  surface.patchNames = mesh.patchNames;
  surface.patch = mesh.patch;
  for (Id f = mesh.internalFaces(); f < mesh.faceCount(); ++f) surface.polygons.push(mesh.faces[f]);
  return surface;
}

PolyMesh bentRoom() {
  testing::VoxelOptions o;
  o.wallSide = {false, true, true, true, true, true};
  o.deform = [](const Vec3& p) {
    return Vec3(p.x(), p.y() + 0.1 * p.x() * p.z(), p.z() + 0.01 * p.x() * p.y());
  };
  return testing::layeredVoxels(o);
}

double volume(const std::vector<Vec3>& corners) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); i += 3)
    sum += corners[i].dot(corners[i + 1].cross(corners[i + 2])) / 6;
  return sum;
}

/// About the mean of the corners of each polygon.
double volume(const PolygonSurface& surface) {
  double sum = 0;
  for (Id i = 0; i < surface.polygons.rows(); ++i) {
    const Span<Id> row = surface.polygons[i];
    Vec3 centre = Vec3::Zero();
    for (Id p : row) centre += surface.points[p] / static_cast<double>(row.size());
    for (std::size_t k = 0; k < row.size(); ++k) {
      sum += centre.dot(surface.points[row[k]].cross(surface.points[row[(k + 1) % row.size()]])) / 6;
    }
  }
  return sum;
}

TEST_F(StlWriter, TrianglesAreClosedAndEncloseTheVolume) {
  const PolygonSurface surface = boundaryOf(bentRoom());
  std::vector<Vec3> all;
  for (const auto& [name, corners] : write(surface)) all.insert(all.end(), corners.begin(), corners.end());
  EXPECT_NEAR(volume(all), volume(surface), 1e-12 * volume(surface));
  std::map<std::array<double, 6>, int> edges;  // each edge once in each direction
  const auto key = [](const Vec3& a, const Vec3& b) {
    return std::array<double, 6>{a.x(), a.y(), a.z(), b.x(), b.y(), b.z()};
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Vec3 &a = all[i], &b = all[i % 3 == 2 ? i - 2 : i + 1];
    ++edges[key(a, b)];
    --edges[key(b, a)];
  }
  EXPECT_GT(edges.size(), all.size() / 2);
  for (const auto& [edge, count] : edges) EXPECT_EQ(count, 0);
}

TEST_F(StlWriter, FlatQuadsAreCutInTwo) {
  PolygonSurface surface;
  surface.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.1, 0.1, 0}, {1, 1, 1e-9}, {0.5, 0, 0}};
  surface.patchNames = {"flat", "dart", "warped", "polygon"};
  for (const std::vector<Id>& row :
       {std::vector<Id>{0, 1, 2, 3}, {4, 1, 2, 3}, {0, 1, 5, 3}, {0, 6, 1, 2, 3}}) {
    surface.polygons.push(row);
    surface.patch.push_back(static_cast<Id>(surface.patch.size()));
  }
  const auto solids = write(surface);
  EXPECT_EQ(solids.at("flat").size(), 6u);
  ASSERT_EQ(solids.at("dart").size(), 6u);  // from its notch
  for (std::size_t i = 0; i < 6; i += 3) {
    const std::vector<Vec3>& p = solids.at("dart");
    EXPECT_GT((p[i + 1] - p[i]).cross(p[i + 2] - p[i]).z(), 0);
  }
  EXPECT_EQ(solids.at("warped").size(), 12u);
  EXPECT_EQ(solids.at("polygon").size(), 15u);
}

TEST_F(StlWriter, SolidsAreThePatches) {
  PolygonSurface surface = boundaryOf(bentRoom());
  surface.patchNames[0] = "main wall\n";
  const auto solids = write(surface);
  ASSERT_EQ(solids.size(), 2u);  // the other sides are walls: their patches have no faces
  const auto faces = static_cast<std::size_t>(std::count(surface.patch.begin(), surface.patch.end(), 1));
  EXPECT_EQ(faces, 9u + 12u);                      // voxels, and prisms around them
  EXPECT_EQ(solids.at("xmin").size(), 6 * faces);  // flat: two triangles each
  EXPECT_GE(solids.at("main wall ").size(), 5u * 9 * 6);
  for (const Vec3& p : solids.at("xmin")) EXPECT_EQ(p.x(), 0);
}

TEST_F(StlWriter, CoordinatesKeepEveryBit) {
  PolygonSurface surface;
  surface.points = {{1.0 / 3, 1e6 + 1e-7, -1e-300}, {0.1f, 0.1, 2}, {5, 6, 7}};
  surface.polygons.push(std::vector<Id>{0, 1, 2});
  surface.patch = {0};
  surface.patchNames = {""};
  EXPECT_EQ(write(surface).at(""), surface.points);
}

TEST_F(StlWriter, ErrorsLeaveTheOldFile) {
  std::ofstream(file()) << "old";
  PolygonSurface surface;
  EXPECT_THROW(writeStl(surface, file(), monitor_), InputError);
  surface = boundaryOf(bentRoom());
  struct Stop : Monitor {
    bool aborted() const override { return true; }
  } stop;
  EXPECT_THROW(writeStl(surface, file(), stop), AbortError);
  EXPECT_THROW(writeStl(surface, (folder_ / "none" / "a.stl").string(), monitor_), InputError);
  if (fs::exists("/dev/full")) {
    fs::create_symlink("/dev/full", file() + ".part");
    EXPECT_THROW(writeStl(surface, file(), monitor_), InputError);
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
  std::string text;
  std::ifstream(file()) >> text;
  EXPECT_EQ(text, "old");
}

}  // namespace
}  // namespace pm
