// SPDX-License-Identifier: BSD-3-Clause
// Octree and painting on a folder of real models, at three feature sizes each: the predicates hold, and each
// run ends in a painted domain or in a sentence. The folder (.stl, .obj, .ply, also .gz, searched with its
// subfolders) is named by the environment variable PROJECTIONMESHER_GEOMETRY; without it the test is skipped.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "FrontPredicates.h"
#include "GeometryInput.h"
#include "OctreeDecompose.h"
#include "PaintFront.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkSurfaceReader.h"

namespace pm {
namespace {

namespace fs = std::filesystem;

constexpr double kDivisions[] = {20, 50, 100};  // of the geometry's diagonal

std::vector<fs::path> collection() {
  std::vector<fs::path> files;
  const char* folder = std::getenv("PROJECTIONMESHER_GEOMETRY");
  if (!folder || !fs::is_directory(folder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    fs::path name = entry.path();
    if (name.extension() == ".gz") name.replace_extension();
    std::string ending = name.extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (ending == ".stl" || ending == ".obj" || ending == ".ply") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// What became of one side of one model.
std::string paint(const Octree& tree, const SurfaceModel& model, Region region) {
  PaintFrontOptions options;
  options.region = region;
  Monitor monitor;
  try {
    PaintFrontReport report;
    const PolyMesh mesh = paintFront(tree, model, options, monitor, &report);
    EXPECT_EQ(checkTopology(mesh), "");
    EXPECT_GT(mesh.cellCount, 0);
    EXPECT_TRUE(frontIsManifold(tree, report.painted));
    EXPECT_TRUE(frontIsPermitted(tree, report.painted));
    return fmt::format("{} cells", mesh.cellCount);
  } catch (const RegionError& sentence) {
    EXPECT_GT(std::string(sentence.what()).size(), 40u);
    return "nothing";
  }
}

TEST(GeometryCollection, EachRunEndsInADomainOrASentence) {
  const std::vector<fs::path> files = collection();
  if (files.empty()) GTEST_SKIP() << "PROJECTIONMESHER_GEOMETRY names no folder of models";
  for (const fs::path& file : files) {
    SCOPED_TRACE(file.string());
    vtkNew<vtkSurfaceReader> reader;
    reader->SetFileName(file.c_str());
    reader->Update();
    if (reader->GetOutput()->GetNumberOfPolys() == 0) {
      fmt::print("{:40} unreadable, see the reader's sentence\n", file.filename().string());
      continue;
    }
    const auto model = surfaceFrom(reader->GetOutput(), nullptr);
    for (double divisions : kDivisions) {
      OctreeDecomposeOptions options;
      options.featureSize = model->bounds().diagonal() / divisions;
      Monitor monitor;
      const Octree tree = decompose(*model, options, monitor);
      EXPECT_TRUE(isComplete(tree));
      EXPECT_TRUE(isBalanced(tree));
      EXPECT_TRUE(findsAllTriangles(tree, *model));
      const std::string inside = paint(tree, *model, Region::Inside);
      const std::string outside = paint(tree, *model, Region::Outside);
      fmt::print("{:40} 1/{:<4} {:8} leaves, inside {}, outside {}\n", file.filename().string(), divisions,
                 tree.size(), inside, outside);
      std::fflush(stdout);
    }
  }
}

}  // namespace
}  // namespace pm
