// SPDX-License-Identifier: BSD-3-Clause
// The regions that painting finds, the choice among them, and zones of one mesh.
#include "Regions.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <random>
#include <sstream>

#include "FoamWriter.h"
#include "FrontPredicates.h"
#include "MeshQuality.h"
#include "Pipeline.h"
#include "TestRooms.h"

namespace {

using namespace pm;
using namespace pm::testing;

constexpr double kSize = 0.06;

Octree octreeOf(const SurfaceModel& model, double size = kSize) {
  OctreeDecomposeOptions o;
  o.featureSize = size;
  Monitor monitor;
  return decompose(model, o, monitor);
}

PolyMesh paint(const SurfaceModel& model, const PaintFrontOptions& options,
               PaintFrontReport* report = nullptr, double size = kSize) {
  Monitor monitor;
  return paintFront(octreeOf(model, size), model, options, monitor, report);
}

/// The same sets as connectedLeaves, by a flood from each leaf.
std::vector<Id> flooded(const Octree& tree, const std::vector<std::uint8_t>& member) {
  std::vector<Id> number(tree.size(), kNone), stack;
  Id count = 0;
  for (Id seed = 0; seed < tree.size(); ++seed) {
    if (!member[seed] || number[seed] != kNone) continue;
    stack.assign(1, seed);
    number[seed] = count;
    while (!stack.empty()) {
      const Id leaf = stack.back();
      stack.pop_back();
      std::array<Id, 4> n;
      for (int side = 0; side < 6; ++side)
        for (int k = tree.faceNeighbours(leaf, side, n); k-- > 0;)
          if (member[n[k]] && number[n[k]] == kNone) {
            number[n[k]] = count;
            stack.push_back(n[k]);
          }
    }
    ++count;
  }
  return number;
}

TEST(Regions, ConnectedLeavesAreThoseOfAFloodOnAnyNumberOfThreads) {
  std::mt19937 random(7);
  for (unsigned seed = 0; seed < 5; ++seed) {
    const Octree tree = octreeOf(*randomSoup(60, 0.3, seed).model(), 0.05);
    std::vector<std::uint8_t> member(tree.size());
    for (auto& m : member) m = random() % 5 < 2;  // many sets, some of them winding
    const std::vector<Id> wanted = flooded(tree, member);
    EXPECT_GT(*std::max_element(wanted.begin(), wanted.end()), 100);
    for (int threads : {1, 2, 4})
      withThreads(threads, [&] { EXPECT_EQ(connectedLeaves(tree, member), wanted); });
  }
}

TEST(Regions, AreListedWithWhatAUserAsks) {
  const auto model = threeRooms().model();
  const Octree tree = octreeOf(*model);
  const Regions regions = findRegions(tree, *model);
  ASSERT_EQ(regions.list.size(), 4u) << "the outside and three rooms";
  EXPECT_TRUE(regions.list[0].open);
  const double lengths[3] = {1, 0.6, 0.4};
  const std::vector<std::vector<Id>> patches{{0, 3}, {1, 3}, {2}};
  for (int room = 0; room < 3; ++room) {
    const PaintedRegion& r = regions.list[room + 1];
    EXPECT_FALSE(r.open);
    EXPECT_LT(r.volume, lengths[room]);
    EXPECT_GT(r.volume, (lengths[room] - 4 * kSize) * std::pow(1 - 4 * kSize, 2));
    EXPECT_EQ(r.patches, patches[room]) << room;
    EXPECT_TRUE(r.bounds.contains(r.point));
    EXPECT_EQ(regions.ofLeaf[tree.locate(r.point)], room + 1);
    EXPECT_LT(r.bounds.size()[0], lengths[room]);
  }
  std::vector<Id> cells(4, 0);
  std::vector<double> volume(4, 0.0);
  for (Id leaf = 0; leaf < tree.size(); ++leaf) {
    EXPECT_EQ(regions.ofLeaf[leaf] == kNone, tree.cut[leaf] != 0);
    if (tree.cut[leaf]) continue;
    ++cells[regions.ofLeaf[leaf]];
    volume[regions.ofLeaf[leaf]] += tree.brick.cellSize(tree.levels[leaf]).prod();
  }
  for (int r = 0; r < 4; ++r) {
    EXPECT_EQ(regions.list[r].cells, cells[r]);
    EXPECT_NEAR(regions.list[r].volume, volume[r], 1e-9);
  }
}

TEST(Regions, TrianglesOfLeavesComeBackAsTheOctreeHadThem) {
  const auto model = randomSoup(200, 0.3, 3).model();
  const Octree tree = octreeOf(*model);
  Octree read = tree;
  read.triangles.values.clear();
  read.triangles.offsets.assign(tree.size() + 1, 0);
  listTriangles(read, *model);
  EXPECT_EQ(read.triangles.offsets, tree.triangles.offsets);
  EXPECT_EQ(read.triangles.values, tree.triangles.values);
}

std::vector<int> chosen(const SurfaceModel& model, const PaintFrontOptions& options) {
  PaintFrontReport report;
  paint(model, options, &report);
  std::vector<int> ids;
  for (std::size_t r = 0; r < report.regions.size(); ++r)
    if (report.regions[r].chosen) ids.push_back(static_cast<int>(r));
  return ids;
}

TEST(Regions, AreChosenByKindIdPointAndPatch) {
  const auto model = threeRooms().model();
  PaintFrontOptions o;
  EXPECT_EQ(chosen(*model, o), (std::vector<int>{1}));
  o.region = Region::Outside;
  EXPECT_EQ(chosen(*model, o), (std::vector<int>{0}));
  o.region = Region::Enclosed;
  EXPECT_EQ(chosen(*model, o), (std::vector<int>{1, 2, 3}));
  o.region = Region::Everything;
  EXPECT_EQ(chosen(*model, o), (std::vector<int>{0, 1, 2, 3}));
  o.region = Region::Ids;
  o.ids = {3, 1};
  EXPECT_EQ(chosen(*model, o), (std::vector<int>{1, 3}));
  o.region = Region::Points;
  o.points = {Vec3(2.1, 0.5, 0.5), Vec3(1.3, 0.5, 0.5)};
  EXPECT_EQ(chosen(*model, o), (std::vector<int>{2, 3}));
  o.region = Region::Patches;
  o.patches = {"between"};
  EXPECT_EQ(chosen(*model, o), (std::vector<int>{1, 2})) << "both rooms beside the sheet";
  o.patches = {"room3", "room1"};
  EXPECT_EQ(chosen(*model, o), (std::vector<int>{1, 3}));
}

TEST(Regions, WrongChoicesAreNamed) {
  const auto model = threeRooms().model();
  PaintFrontOptions o;
  o.region = Region::Ids;
  EXPECT_THROW(paint(*model, o), InputError) << "no ids";
  for (Id id : {-1, 4}) {
    o.ids = {id};
    EXPECT_THROW(paint(*model, o), RegionError) << id;
  }
  o.ids = {0};
  EXPECT_THROW(paint(*model, o), RegionError) << "the outside is open";
  o.allowOpen = true;
  EXPECT_GT(paint(*model, o).cellCount, 0);
  o.region = Region::Patches;
  EXPECT_THROW(paint(*model, o), InputError) << "no patches";
  o.patches = {"ceiling"};
  try {
    paint(*model, o);
    FAIL() << "there is no such patch";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("room1, room2, room3, between"), std::string::npos)
        << error.what();
  }
}

/// Volume of each zone's cells.
std::vector<double> zoneVolumes(const PolyMesh& mesh) {
  const MeshMeasures m = measure(mesh);
  std::vector<double> volumes(mesh.zoneNames.size(), 0.0);
  for (Id c = 0; c < mesh.cellCount; ++c) volumes[mesh.zone[c]] += m.cells[c].volume;
  return volumes;
}

void expectZonesApart(const PolyMesh& mesh) {
  EXPECT_EQ(checkTopology(mesh), "");
  const Csr<Id> cellsOf = pointCells(mesh, cellFaces(mesh));
  Id shared = 0;
  for (Id p = 0; p < cellsOf.rows(); ++p)
    for (Id c : cellsOf[p]) shared += mesh.zone[c] != mesh.zone[cellsOf[p][0]];
  EXPECT_EQ(shared, 0) << "points of two zones";
}

TEST(Zones, OneForEachRegionNamedAfterItsOwnPatch) {
  const auto model = threeRooms().model();
  PaintFrontOptions o;
  o.region = Region::Enclosed;
  PaintFrontReport report;
  const PolyMesh mesh = paint(*model, o, &report);
  EXPECT_EQ(mesh.zoneNames, (std::vector<std::string>{"region_1", "region_2", "room3"}));
  expectZonesApart(mesh);
  ASSERT_EQ(report.regionOfCell.size(), static_cast<std::size_t>(mesh.cellCount));
  for (Id c = 0; c < mesh.cellCount; ++c) EXPECT_EQ(report.regionOfCell[c], mesh.zone[c] + 1);
  // Each is the mesh of its region alone.
  for (Id zone = 0; zone < 3; ++zone) {
    o.region = Region::Ids;
    o.ids = {zone + 1};
    const PolyMesh alone = paint(*model, o);
    EXPECT_TRUE(alone.zone.empty());
    EXPECT_TRUE(alone.zoneNames.empty());
    EXPECT_EQ(alone.cellCount, std::count(mesh.zone.begin(), mesh.zone.end(), zone));
  }
}

TEST(Zones, GoThroughEveryStage) {
  const auto model = threeRooms().model();
  PipelineOptions o;
  o.octree.featureSize = kSize;
  o.front.region = Region::Enclosed;
  o.refine.layers = 3;
  Monitor monitor;
  for (Stage last : {Stage::Layer, Stage::Projected, Stage::Resolved, Stage::Refined}) {
    o.stopAfter = last;
    const PolyMesh mesh = runPipeline(*model, o, monitor);
    ASSERT_EQ(mesh.zoneNames.size(), 3u);
    expectZonesApart(mesh);
    if (last < Stage::Resolved) continue;
    const std::vector<double> volumes = zoneVolumes(mesh);
    const double wanted[3] = {1, 0.6, 0.4};
    for (int zone = 0; zone < 3; ++zone) EXPECT_NEAR(volumes[zone], wanted[zone], 0.01) << zone;
  }
}

TEST(Zones, AreInTheChecksum) {
  const auto model = threeRooms().model();
  PaintFrontOptions o;
  o.region = Region::Enclosed;
  PolyMesh mesh = paint(*model, o);
  const std::uint64_t before = checksum(mesh);
  std::swap(mesh.zoneNames[0], mesh.zoneNames[1]);
  EXPECT_NE(checksum(mesh), before);
  std::swap(mesh.zoneNames[0], mesh.zoneNames[1]);
  EXPECT_EQ(checksum(mesh), before);
  mesh.zone[0] = 1 - mesh.zone[0];
  EXPECT_NE(checksum(mesh), before);
  EXPECT_NE(checkTopology(mesh), "") << "a cell beside cells of another zone";
}

/// The cells of each zone in a cellZones file, in order.
std::vector<std::vector<Id>> readZones(const std::filesystem::path& path, bool binary) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream all;
  all << in.rdbuf();
  std::string text = all.str();
  std::vector<std::vector<Id>> zones;
  for (std::size_t at = text.find("List<label>"); at != std::string::npos;
       at = text.find("List<label>", at)) {
    char* end = nullptr;
    zones.emplace_back(std::strtol(text.c_str() + at + 11, &end, 10));
    at = text.find('(', end - text.c_str()) + 1;
    std::istringstream numbers(binary ? std::string() : text.substr(at));
    if (binary) std::memcpy(zones.back().data(), text.data() + at, zones.back().size() * sizeof(Id));
    for (Id& cell : zones.back())
      if (!binary) numbers >> cell;
  }
  return zones;
}

TEST(Zones, AreWrittenForOpenFoam) {
  const auto model = threeRooms().model();
  PaintFrontOptions o;
  o.region = Region::Enclosed;
  const PolyMesh mesh = paint(*model, o);
  o.region = Region::Inside;
  const PolyMesh one = paint(*model, o);
  const auto folder = std::filesystem::temp_directory_path() / ("pm_zones_" + std::to_string(::getpid()));
  std::vector<std::vector<Id>> wanted(3);
  for (Id c = 0; c < mesh.cellCount; ++c) wanted[mesh.zone[c]].push_back(c);
  Monitor monitor;
  for (bool binary : {false, true}) {
    writePolyMesh(mesh, folder.string(), binary, monitor);
    EXPECT_EQ(readZones(folder / "cellZones", binary), wanted);
  }
  writePolyMesh(one, folder.string(), false, monitor);
  EXPECT_FALSE(std::filesystem::exists(folder / "cellZones")) << "of the former mesh";
  std::filesystem::remove_all(folder);
}

// Every region of a random soup at once: many of them separated by one layer of cut cells, where filling and
// growing could join them.
TEST(Zones, OfRandomSoupsStayApart) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const auto model = randomSoup(150, 0.6, seed).model();
    PaintFrontOptions o;
    o.region = Region::Everything;
    PaintFrontReport report;
    const PolyMesh mesh = paint(*model, o, &report, 0.08);
    ASSERT_GT(mesh.zoneNames.size(), 1u) << seed;
    expectZonesApart(mesh);
    const Octree tree = octreeOf(*model, 0.08);
    std::vector<std::uint8_t> painted(tree.size(), 0);
    for (Id c = 0; c < mesh.cellCount; ++c) EXPECT_TRUE(report.regions[report.regionOfCell[c]].chosen);
    const MeshMeasures m = measure(mesh);
    std::vector<Id> leafOf(mesh.cellCount);
    for (Id c = 0; c < mesh.cellCount; ++c) {
      leafOf[c] = tree.locate(m.cells[c].centre);
      painted[leafOf[c]] = 1;
    }
    EXPECT_TRUE(frontIsManifold(tree, painted));
    EXPECT_TRUE(frontIsPermitted(tree, painted));
    for (Id zone = 0; zone < static_cast<Id>(mesh.zoneNames.size()); ++zone) {
      std::vector<std::uint8_t> own(tree.size(), 0);
      for (Id c = 0; c < mesh.cellCount; ++c) own[leafOf[c]] = mesh.zone[c] == zone;
      EXPECT_TRUE(frontIsManifold(tree, own)) << mesh.zoneNames[zone];
    }
  }
}

}  // namespace
