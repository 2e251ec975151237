// SPDX-License-Identifier: BSD-3-Clause
#include "FoamWriter.h"

#include <gtest/gtest.h>

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

class FoamWriter : public testing::FolderTest {
 protected:
  /// What follows the header.
  std::string body(const std::string& name) const {
    const std::string all = read(name);
    return all.substr(all.find('}') + 1);
  }
};

std::vector<double> numbers(std::string text) {
  for (char& c : text) {
    if (c == '(' || c == ')') c = ' ';
  }
  std::istringstream in(text);
  std::vector<double> out;
  for (double x; in >> x;) out.push_back(x);
  return out;
}

/// One "count(raw values)" list; at moves behind it.
template <class T>
std::vector<T> rawList(const std::string& text, std::size_t& at) {
  const std::size_t open = text.find('(', at);
  std::vector<T> values(std::stoul(text.substr(at)));
  std::memcpy(values.data(), text.data() + open + 1, values.size() * sizeof(T));
  at = open + 1 + values.size() * sizeof(T);
  EXPECT_EQ(text[at], ')');
  ++at;
  return values;
}

/// Internal faces as they are, then the patches' in their order.
std::vector<Id> expectedOrder(const PolyMesh& mesh) {
  std::vector<Id> order;
  for (Id f = 0; f < mesh.internalFaces(); ++f) order.push_back(f);
  for (Id patch = 0; patch < static_cast<Id>(mesh.patchNames.size()); ++patch) {
    for (Id i = 0; i < mesh.boundaryFaces(); ++i) {
      if (mesh.patch[i] == patch) order.push_back(mesh.internalFaces() + i);
    }
  }
  return order;
}

TEST_F(FoamWriter, AsciiKeepsEveryBit) {
  const PolyMesh mesh = testing::hollowRoom();
  writePolyMesh(mesh, folder_.string(), false, monitor_);
  const std::vector<double> points = numbers(body("points"));
  ASSERT_EQ(points.size(), 1 + 3 * mesh.points.size());
  EXPECT_EQ(points[0], static_cast<double>(mesh.points.size()));
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    for (int a = 0; a < 3; ++a) ASSERT_EQ(points[1 + 3 * i + a], mesh.points[i][a]);
  }
  std::vector<double> faces{static_cast<double>(mesh.faceCount())}, owner = faces;
  for (Id f : expectedOrder(mesh)) {
    faces.push_back(static_cast<double>(mesh.faces[f].size()));
    for (Id p : mesh.faces[f]) faces.push_back(p);
    owner.push_back(mesh.owner[f]);
  }
  EXPECT_EQ(numbers(body("faces")), faces);
  EXPECT_EQ(numbers(body("owner")), owner);
  std::vector<double> neighbour{static_cast<double>(mesh.internalFaces())};
  neighbour.insert(neighbour.end(), mesh.neighbour.begin(), mesh.neighbour.end());
  EXPECT_EQ(numbers(body("neighbour")), neighbour);
}

TEST_F(FoamWriter, BinaryHoldsTheSame) {
  const PolyMesh mesh = testing::hollowRoom();
  writePolyMesh(mesh, folder_.string(), true, monitor_);
  std::size_t at = 0;
  const std::string points = body("points"), faces = body("faces"), owner = body("owner");
  const std::size_t list = points.find_first_of("0123456789");
  ASSERT_EQ(std::stoul(points.substr(list)), mesh.points.size());
  EXPECT_EQ(std::memcmp(points.data() + points.find('(') + 1, mesh.points.data(), 24 * mesh.points.size()),
            0);
  const std::vector<Id> offsets = rawList<Id>(faces, at), values = rawList<Id>(faces, at);
  const std::vector<Id> order = expectedOrder(mesh);
  ASSERT_EQ(offsets.size(), order.size() + 1);
  at = 0;
  const std::vector<Id> owners = rawList<Id>(owner, at);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Span<Id> row = mesh.faces[order[i]];
    EXPECT_EQ(std::vector<Id>(values.begin() + offsets[i], values.begin() + offsets[i + 1]),
              std::vector<Id>(row.begin(), row.end()));
    EXPECT_EQ(owners[i], mesh.owner[order[i]]);
  }
  EXPECT_NE(read("faces").find("faceCompactList"), std::string::npos);
  EXPECT_NE(read("faces").find("LSB;label=32;scalar=64"), std::string::npos);
  EXPECT_NE(read("boundary").find("format      ascii"), std::string::npos);
}

TEST_F(FoamWriter, NamesTellWallsFromOpenings) {
  PolyMesh mesh;
  mesh.patchNames = {"Inlet_1", "main-outlet", "outer wall", "xmin"};
  mesh.patchTypes = {"wall", "wall", "wall", "patch"};
  EXPECT_EQ(foamPatchType(mesh, 0), "patch");
  EXPECT_EQ(foamPatchType(mesh, 1), "patch");
  EXPECT_EQ(foamPatchType(mesh, 2), "wall");
  EXPECT_EQ(foamPatchType(mesh, 3), "patch");
}

TEST_F(FoamWriter, BoundaryCoversAllFacesOnce) {
  const PolyMesh mesh = testing::hollowRoom();
  writePolyMesh(mesh, folder_.string(), false, monitor_);
  std::istringstream in(body("boundary"));
  std::string word;
  std::map<std::string, std::array<Id, 2>> patches;
  std::map<std::string, std::string> types;
  std::string name;
  Id count = 0;
  in >> count >> word;
  while (in >> word && word != ")") {
    name = word;
    in >> word;
    ASSERT_EQ(word, "{");
    while (in >> word && word != "}") {
      std::string value;
      in >> value;
      if (word == "type") types[name] = value;
      if (word == "nFaces") patches[name][0] = static_cast<Id>(std::stol(value));
      if (word == "startFace") patches[name][1] = static_cast<Id>(std::stol(value));
    }
  }
  EXPECT_EQ(count, 4);  // ymin, ymax and zmax are walls: their patches have no faces and are left out
  ASSERT_EQ(patches.size(), 4u);
  EXPECT_EQ(types["wall"], "wall;");
  EXPECT_EQ(types["xmin"], "patch;");
  Id next = mesh.internalFaces();
  for (const char* patch : {"wall", "xmin", "xmax", "zmin"}) {
    EXPECT_EQ(patches[patch][1], next);
    next += patches[patch][0];
  }
  EXPECT_EQ(next, mesh.faceCount());
  EXPECT_EQ(patches["wall"][0], 6 + 3 * 9);
}

TEST_F(FoamWriter, NoteTellsTheCounts) {
  const PolyMesh mesh = testing::hollowRoom();
  writePolyMesh(mesh, folder_.string(), true, monitor_);
  std::ostringstream note;
  note << "nPoints:" << mesh.points.size() << "  nCells:" << mesh.cellCount << "  nFaces:" << mesh.faceCount()
       << "  nInternalFaces:" << mesh.internalFaces();
  EXPECT_NE(read("owner").find(note.str()), std::string::npos);
}

TEST(FoamPatchNames, AreWordsAndDifferent) {
  const std::vector<std::string> names{"inlet 1", "inlet_1", "a/b\"c", "3wheel", "", "inlet 1", "ok-1.x"};
  const std::vector<std::string> expected{"inlet_1_2", "inlet_1",   "a_b_c", "patch_3wheel",
                                          "patch_",    "inlet_1_3", "ok-1.x"};
  EXPECT_EQ(foamPatchNames(names), expected);
}

TEST_F(FoamWriter, StaleFilesGoOthersStay) {
  fs::create_directories(folder_);
  for (const char* name : {"cellZones", "points.gz", "mine.txt"}) std::ofstream(folder_ / name) << "old";
  writePolyMesh(testing::hollowRoom(), folder_.string(), false, monitor_);
  EXPECT_FALSE(fs::exists(folder_ / "cellZones"));
  EXPECT_FALSE(fs::exists(folder_ / "points.gz"));
  EXPECT_TRUE(fs::exists(folder_ / "mine.txt"));
}

TEST_F(FoamWriter, FolderThatCannotBeMadeIsAnInputError) {
  std::ofstream(folder_) << "a file, not a folder";
  try {
    writePolyMesh(testing::hollowRoom(), (folder_ / "polyMesh").string(), false, monitor_);
    FAIL() << "no error";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find(folder_.string()), std::string::npos);
  }
}

TEST_F(FoamWriter, FullDiskIsAnInputErrorAndKeepsTheOldMesh) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "needs /dev/full";
  fs::create_directories(folder_);
  std::ofstream(folder_ / "points") << "old";
  fs::create_symlink("/dev/full", folder_ / "owner.part");
  EXPECT_THROW(writePolyMesh(testing::hollowRoom(), folder_.string(), true, monitor_), InputError);
  EXPECT_EQ(read("points"), "old");
  for (const auto& entry : fs::directory_iterator(folder_)) EXPECT_EQ(entry.path().filename(), "points");
}

TEST_F(FoamWriter, NameThatIsTakenByAFolderIsAnInputError) {
  fs::create_directories(folder_ / "points" / "inside");
  EXPECT_THROW(writePolyMesh(testing::hollowRoom(), folder_.string(), true, monitor_), InputError);
  EXPECT_FALSE(fs::exists(folder_ / "faces"));
}

TEST_F(FoamWriter, AbortLeavesNothingHalfMade) {
  struct Stop : Monitor {
    int calls = 0;
    bool aborted() const override { return calls > 3; }
    void progress(double, const std::string&) override { ++calls; }
  } stop;
  EXPECT_THROW(writePolyMesh(testing::hollowRoom(), folder_.string(), false, stop), AbortError);
  EXPECT_TRUE(fs::is_empty(folder_));
}

}  // namespace
}  // namespace pm
