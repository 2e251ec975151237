// SPDX-License-Identifier: BSD-3-Clause
#include "ConvertCells.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "CutAssembly.h"
#include "FoamQuality.h"

namespace pm {
namespace {

/// By how many faces of which size each cell has; all are known to be standard cells.
void countShapes(const PolyMesh& mesh, ConvertCellsReport& report) {
  std::vector<std::uint8_t> quads(mesh.cellCount, 0);
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    if (mesh.faces[f].size() != 4) continue;
    ++quads[mesh.owner[f]];
    if (f < mesh.internalFaces()) ++quads[mesh.neighbour[f]];
  }
  for (std::uint8_t q : quads)
    ++(q == 0 ? report.tetrahedra : q == 1 ? report.pyramids : q == 3 ? report.wedges : report.hexahedra);
}

/// Volume within the boundary faces, by their central triangles (4-19).
double enclosedVolume(const PolyMesh& mesh) {
  Vec3 origin = mesh.points.empty() ? Vec3(Vec3::Zero()) : mesh.points[0];
  double volume = 0;
  for (Id f = mesh.internalFaces(); f < mesh.faceCount(); ++f) {
    const Span<Id> row = mesh.faces[f];
    const Vec3 centre = measureFace(mesh.points, row, true).centre - origin;
    Vec3 a = mesh.points[row[row.size() - 1]] - origin;
    for (Id p : row) {
      const Vec3 b = mesh.points[p] - origin;
      volume += a.cross(b).dot(centre) / 6;
      a = b;
    }
  }
  return volume;
}

/// OpenFOAM's skewness and non-orthogonality of all faces.
struct FaceTable {
  std::vector<float> skewness;          // #F
  std::vector<float> nonOrthogonality;  // #internal faces, degrees
};

FaceTable measureFaces(const PolyMesh& mesh) {
  const MeshMeasures m = measure(mesh);
  FaceTable table;
  table.skewness = m.faceSkew;
  table.nonOrthogonality.resize(mesh.internalFaces());
  tbb::parallel_for(Id(0), mesh.internalFaces(), [&](Id f) {
    const Vec3 between = m.cells[mesh.neighbour[f]].foamCentre - m.cells[mesh.owner[f]].foamCentre;
    table.nonOrthogonality[f] = static_cast<float>(faceAngle(m.faces[f].normal, between));
  });
  return table;
}

/// Old cells at faces that are skewer than the limit, ascending.
std::vector<Id> cellsAtSkewFaces(const PolyMesh& mesh, const FaceTable& table,
                                 const std::vector<Id>& firstCell) {
  std::vector<Id> found;
  const auto add = [&](Id newCell) {
    found.push_back(
        static_cast<Id>(std::upper_bound(firstCell.begin(), firstCell.end(), newCell) - firstCell.begin()) -
        1);
  };
  const double limit = QualityLimits().maxSkewInternal;
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    if (table.skewness[f] <= limit) continue;
    add(mesh.owner[f]);
    if (f < mesh.internalFaces()) add(mesh.neighbour[f]);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

void fillReport(const PolyMesh& mesh, const CellCuts& cuts, const PolyMesh& out, const FaceTable& table,
                ConvertCellsReport& report) {
  report = ConvertCellsReport();
  countShapes(out, report);
  const auto count = [](const std::vector<Id>& values, Id value) {
    return static_cast<Id>(std::count(values.begin(), values.end(), value));
  };
  report.cellsThatStay = count(cuts.apex, CellCuts::kWhole);
  report.cellCentres = count(cuts.apex, CellCuts::kCentre);
  report.faceCentres = count(cuts.fan, CellCuts::kCentre);
  report.volume = enclosedVolume(out);
  report.volumeChange = report.volume - enclosedVolume(mesh);
  for (float skewness : table.skewness) report.maxSkewness = std::max<double>(report.maxSkewness, skewness);
  for (float angle : table.nonOrthogonality) {
    report.maxNonOrthogonality = std::max<double>(report.maxNonOrthogonality, angle);
    report.nonOrthogonalFaces += angle > FoamLimits().maxNonOrthogonality;
  }
}

}  // namespace

PolyMesh convertCells(const PolyMesh& mesh, const ConvertCellsOptions& options, Monitor& monitor,
                      ConvertCellsReport* report) {
  constexpr int kMostMends = 4;  // a cell has two steps to take, and may be reached by its neighbours'
  PartMonitor choosing(monitor, 0, 0.4), assembling(monitor, 0.4, 0.8), mending(monitor, 0.8, 1);
  CutChooser chooser(mesh, options.shapes == CellShapes::Hybrid, choosing);
  const CellCuts& cuts = chooser.choose();
  std::vector<Id> firstCell;
  PolyMesh out = assembleCuts(mesh, cuts, assembling, firstCell);
  FaceTable table;
  for (int mends = 0;; ++mends) {
    mending.check(double(mends) / (kMostMends + 1), "measuring faces");
    table = measureFaces(out);
    const std::vector<Id> skew = cellsAtSkewFaces(out, table, firstCell);
    if (skew.empty() || mends == kMostMends) break;
    chooser.mend(skew);
    out = assembleCuts(mesh, cuts, assembling, firstCell);
  }
  out.stage = Stage::Refined;
  if (report) fillReport(mesh, cuts, out, table, *report);
  return out;
}

}  // namespace pm
