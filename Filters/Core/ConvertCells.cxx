// SPDX-License-Identifier: BSD-3-Clause
#include "ConvertCells.h"

#include <algorithm>
#include <cmath>

#include "Chunks.h"
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

/// OpenFOAM's centre of each cell; a tetrahedron's is the mean of its points.
std::vector<Vec3> foamCentres(const PolyMesh& mesh, Monitor& monitor) {
  const Csr<Id> facesOf = cellFaces(mesh);
  const auto faceCentre = [&](Id f) { return measureFace(mesh.points, mesh.faces[f], true).centre; };
  std::vector<Vec3> centres(mesh.cellCount);
  forChunks(mesh.cellCount, monitor, 0.2, "measuring cells", [&](Id c) {
    thread_local std::vector<Id> points;
    points.clear();
    for (Id f : facesOf[c]) points.insert(points.end(), mesh.faces[f].begin(), mesh.faces[f].end());
    sortUnique(points);
    const Span<Id> own{points.data(), points.data() + points.size()};
    Vec3 sum = Vec3::Zero();
    for (Id p : own) sum += mesh.points[p] - mesh.points[own[0]];
    centres[c] = own.size() == 4 ? Vec3(mesh.points[own[0]] + sum / 4)
                                 : measureCell(mesh, c, facesOf[c], own, faceCentre).foamCentre;
  });
  return centres;
}

/// OpenFOAM's skewness and non-orthogonality of all faces.
struct FaceTable {
  std::vector<float> skewness;          // #F
  std::vector<float> nonOrthogonality;  // #internal faces, degrees
};

FaceTable measureFaces(const PolyMesh& mesh, Monitor& monitor) {
  const std::vector<Vec3> centres = foamCentres(mesh, monitor);
  FaceTable table;
  table.skewness.resize(mesh.faceCount());
  table.nonOrthogonality.resize(mesh.internalFaces());
  forChunks(mesh.faceCount(), monitor, 0.6, "measuring faces", [&](Id f) {
    const Span<Id> row = mesh.faces[f];
    const FaceMeasures face = measureFace(mesh.points, row, true);
    const Vec3& own = centres[mesh.owner[f]];
    if (f >= mesh.internalFaces()) {
      table.skewness[f] = static_cast<float>(boundarySkewness(mesh.points, row, face, own));
      return;
    }
    const Vec3& next = centres[mesh.neighbour[f]];
    table.skewness[f] = static_cast<float>(internalSkewness(mesh.points, row, face, own, next));
    table.nonOrthogonality[f] = static_cast<float>(faceAngle(face.normal, next - own));
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
  sortUnique(found);
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
  CutChooser chooser(mesh, options.shapes == CellShapes::Hybrid);
  PolyMesh out;
  const CellCuts* cuts = nullptr;
  FaceTable table;
  std::vector<Id> firstCell, skew;
  for (int mends = 0; mends == 0 || (!skew.empty() && mends <= kMostMends); ++mends) {
    const double from = 1 - std::pow(0.3, mends), to = 1 - std::pow(0.3, mends + 1);
    PartMonitor choosing(monitor, from, 0.6 * from + 0.4 * to);
    PartMonitor assembling(monitor, 0.6 * from + 0.4 * to, 0.2 * from + 0.8 * to);
    PartMonitor measuring(monitor, 0.2 * from + 0.8 * to, to);
    cuts = mends == 0 ? &chooser.choose(choosing) : &chooser.mend(skew, choosing);
    out = assembleCuts(mesh, *cuts, assembling, firstCell);
    table = measureFaces(out, measuring);
    skew = cellsAtSkewFaces(out, table, firstCell);
  }
  out.stage = Stage::Refined;
  if (report) fillReport(mesh, *cuts, out, table, *report);
  return out;
}

}  // namespace pm
