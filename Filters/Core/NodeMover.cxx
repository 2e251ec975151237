// SPDX-License-Identifier: BSD-3-Clause
#include "NodeMover.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pm {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

template <class T>
void sortUnique(std::vector<T>& v) {
  std::sort(v.begin(), v.end());
  v.erase(std::unique(v.begin(), v.end()), v.end());
}

double cosine(const Vec3& normal, const Vec3& direction) {
  const double lengths = std::sqrt(normal.squaredNorm() * direction.squaredNorm());
  return lengths > 0 ? normal.dot(direction) / lengths : -1.0;
}

}  // namespace

/// What one attempt touches and how it was before; reused from attempt to attempt, one for each thread.
struct NodeMover::Touched {
  std::vector<Id> shapes;  // faces of the points: their shape changes
  std::vector<Id> cells;   // cells of the points: volume and centre change
  std::vector<Id> faces;   // all faces of those cells: their angle changes
  std::vector<FaceState> oldFaces;
  std::vector<CellMeasures> oldCells;
  std::vector<Vec3> oldPoints;
};

NodeMover::NodeMover(PolyMesh& mesh, const QualityLimits& limits, const Monitor* monitor)
    : mesh_(mesh),
      monitor_(monitor),
      limits_(limits),
      cosInternal_(std::cos(limits.maxAngleInternal * kDegree)),
      cosBoundary_(std::cos(limits.maxAngleBoundary * kDegree)),
      minVolume_(limits.minVolume * std::pow(mesh.finestSize, 3)),
      // A hair above zero, so that no tetrahedron is flat to rounding.
      minTet_(std::max(limits.minTet, 1e-6) * std::pow(mesh.finestSize, 3)),
      faces_(mesh.faceCount()),
      cells_(mesh.cellCount),
      pointCells_(pointCells(mesh)),
      pointFaces_(pointFaces(mesh)),
      cellFaces_(cellFaces(mesh)),
      cellPoints_(cellPoints(mesh)) {
  tbb::parallel_for(Id(0), mesh.faceCount(),
                    [&](Id f) { faces_[f].shape = measureFace(mesh_.points, mesh_.faces[f]); });
  tbb::parallel_for(Id(0), mesh.cellCount, [&](Id c) { cells_[c] = cellNow(c); });
  tbb::parallel_for(Id(0), mesh.faceCount(), [&](Id f) { relate(f); });
}

CellMeasures NodeMover::cellNow(Id c) const {
  return measureCell(mesh_, c, cellFaces_[c], cellPoints_[c],
                     [&](Id f) -> const Vec3& { return faces_[f].shape.centre; });
}

// Angle and skewness of a face from the current centres.
void NodeMover::relate(Id f) {
  FaceState& s = faces_[f];
  const CellMeasures& own = cells_[mesh_.owner[f]];
  if (f < mesh_.internalFaces()) {
    const CellMeasures& next = cells_[mesh_.neighbour[f]];
    s.cosAngle = cosine(s.shape.normal, next.centre - own.centre);
    s.skew = internalSkewness(mesh_.points, mesh_.faces[f], s.shape, own.foamCentre, next.foamCentre);
  } else {
    s.cosAngle = cosine(s.shape.normal, s.shape.centre - own.centre);
    s.skew = boundarySkewness(mesh_.points, mesh_.faces[f], s.shape, own.foamCentre);
  }
}

bool NodeMover::faceShapeHolds(Id f, const FaceState& old) const {
  const FaceMeasures& now = faces_[f].shape;
  const double minEta = f < mesh_.internalFaces() ? limits_.minEtaInternal : limits_.minEtaBoundary;
  return (now.eta >= minEta || now.eta >= old.shape.eta) &&
         (now.warpage <= limits_.maxWarpage || now.warpage <= old.shape.warpage);
}

bool NodeMover::faceAngleHolds(Id f, const FaceState& old) const {
  const FaceState& now = faces_[f];
  const bool internal = f < mesh_.internalFaces();
  const double minCos = internal ? cosInternal_ : cosBoundary_;
  const double maxSkew = internal ? limits_.maxSkewInternal : limits_.maxSkewBoundary;
  return (now.cosAngle >= minCos || now.cosAngle >= old.cosAngle) &&
         (now.skew <= maxSkew || now.skew <= old.skew);
}

bool NodeMover::cellHolds(const CellMeasures& now, const CellMeasures& old) const {
  return (now.volume >= minVolume_ || now.volume >= old.volume) &&
         (now.minTet >= minTet_ || now.minTet >= old.minTet) &&
         (now.minPyramid >= minTet_ || now.minPyramid >= old.minPyramid);
}

double NodeMover::badnessOfFace(const FaceState& s, bool internal) const {
  const double angle = internal ? limits_.maxAngleInternal : limits_.maxAngleBoundary;
  const double eta = internal ? limits_.minEtaInternal : limits_.minEtaBoundary;
  const double skew = internal ? limits_.maxSkewInternal : limits_.maxSkewBoundary;
  return std::max({std::acos(std::clamp(s.cosAngle, -1.0, 1.0)) / (angle * kDegree),
                   s.shape.warpage / limits_.maxWarpage, s.skew / skew, (1 - s.shape.eta) / (1 - eta)});
}

// Volume and tetrahedra against the limits; below 1 when better.
double NodeMover::badnessOfCell(const CellMeasures& c) const {
  const double size = std::max(c.volume, minVolume_);
  // The mean central tetrahedron of a hexahedron is 1/24 of it; one of no volume is at the limit.
  const double tet = 1 - 24 * std::min(c.minTet, c.minPyramid) / size;
  return std::max(minVolume_ > 0 && c.volume < minVolume_ ? 2 - c.volume / minVolume_ : 0.0, tet);
}

double NodeMover::badness(Id p) const {
  double worst = 0;
  for (Id c : pointCells_[p]) {
    worst = std::max(worst, badnessOfCell(cells_[c]));
    for (Id f : cellFaces_[c]) worst = std::max(worst, badnessOfFace(faces_[f], f < mesh_.internalFaces()));
  }
  return worst;
}

void NodeMover::gather(const Id* points, std::size_t count, Touched& t) const {
  t.shapes.clear(), t.cells.clear(), t.faces.clear();
  for (std::size_t i = 0; i < count; ++i) {
    for (Id f : pointFaces_[points[i]]) t.shapes.push_back(f);
    for (Id c : pointCells_[points[i]]) t.cells.push_back(c);
  }
  if (count > 1) {
    sortUnique(t.shapes);
    sortUnique(t.cells);
  }
  for (Id c : t.cells)
    for (Id f : cellFaces_[c]) t.faces.push_back(f);
  sortUnique(t.faces);
}

// The worst measure got better; or it stayed (two faces of a symmetric prism share it) and what is over the
// limits shrank.
bool NodeMover::isBetter(const Touched& t) const {
  double before = 0, after = 0, excessBefore = 0, excessAfter = 0;
  const auto add = [](double badness, double& worst, double& excess) {
    worst = std::max(worst, badness);
    excess += std::max(0.0, badness - 1);
  };
  for (std::size_t i = 0; i < t.faces.size(); ++i) {
    const bool internal = t.faces[i] < mesh_.internalFaces();
    add(badnessOfFace(t.oldFaces[i], internal), before, excessBefore);
    add(badnessOfFace(faces_[t.faces[i]], internal), after, excessAfter);
  }
  for (std::size_t i = 0; i < t.cells.size(); ++i) {
    add(badnessOfCell(t.oldCells[i]), before, excessBefore);
    add(badnessOfCell(cells_[t.cells[i]]), after, excessAfter);
  }
  return after < before || (after == before && excessAfter < excessBefore);
}

bool NodeMover::attempt(const Id* points, const Vec3* targets, std::size_t count, bool mustImprove) {
  thread_local Touched t;
  t.oldPoints.clear();
  bool moves = false;
  for (std::size_t i = 0; i < count; ++i) {
    Vec3& p = mesh_.points[points[i]];
    t.oldPoints.push_back(p);
    for (int a = 0; a < 3; ++a)
      if (!(mesh_.fixed[points[i]] >> a & 1) && p[a] != targets[i][a]) moves = true;
  }
  if (!moves) return !mustImprove;
  gather(points, count, t);
  t.oldFaces.clear(), t.oldCells.clear();
  for (Id f : t.faces) t.oldFaces.push_back(faces_[f]);
  for (Id c : t.cells) t.oldCells.push_back(cells_[c]);
  for (std::size_t i = 0; i < count; ++i)
    for (int a = 0; a < 3; ++a)
      if (!(mesh_.fixed[points[i]] >> a & 1)) mesh_.points[points[i]][a] = targets[i][a];

  // Cheapest checks first; `faces` is sorted and holds `shapes`, so both are walked side by side.
  const auto holds = [&] {
    std::size_t k = 0;
    for (Id f : t.shapes) {
      while (t.faces[k] != f) ++k;
      faces_[f].shape = measureFace(mesh_.points, mesh_.faces[f]);
      if (!faceShapeHolds(f, t.oldFaces[k])) return false;
    }
    for (std::size_t i = 0; i < t.cells.size(); ++i) {
      cells_[t.cells[i]] = cellNow(t.cells[i]);
      if (!cellHolds(cells_[t.cells[i]], t.oldCells[i])) return false;
    }
    for (std::size_t i = 0; i < t.faces.size(); ++i) {
      relate(t.faces[i]);
      if (!faceAngleHolds(t.faces[i], t.oldFaces[i])) return false;
    }
    return !mustImprove || isBetter(t);
  };
  if (holds()) return true;
  for (std::size_t i = 0; i < count; ++i) mesh_.points[points[i]] = t.oldPoints[i];
  for (std::size_t i = 0; i < t.faces.size(); ++i) faces_[t.faces[i]] = t.oldFaces[i];
  for (std::size_t i = 0; i < t.cells.size(); ++i) cells_[t.cells[i]] = t.oldCells[i];
  return false;
}

double NodeMover::drift(Id p, const Vec3& target, int halvings) {
  const Vec3 start = mesh_.points[p];
  double part = 1;
  for (int k = 0; k <= halvings; ++k, part *= 0.5)
    if (move(p, start + part * (target - start))) return part;
  return 0;
}

std::vector<std::vector<Id>> NodeMover::colour(const std::vector<Id>& points) const {
  // A move writes its cells and their faces and reads the cells across those faces; so two points may share a
  // colour when no cell of one is a cell of the other or a face neighbour of one.
  constexpr int kWords = 3, kColours = 64 * kWords;
  using Mask = std::array<std::uint64_t, kWords>;
  std::vector<Mask> used(mesh_.cellCount, Mask{});
  std::vector<std::vector<Id>> groups;
  std::vector<Id> cells, serial;
  for (Id p : points) {
    cells.assign(pointCells_[p].begin(), pointCells_[p].end());
    if (mesh_.base[p] != kNone)
      cells.insert(cells.end(), pointCells_[mesh_.base[p]].begin(), pointCells_[mesh_.base[p]].end());
    Mask taken{};
    for (Id c : cells)
      for (Id f : cellFaces_[c])
        for (Id side : {mesh_.owner[f], f < mesh_.internalFaces() ? mesh_.neighbour[f] : mesh_.owner[f]})
          for (int w = 0; w < kWords; ++w) taken[w] |= used[side][w];
    int colour = 0;
    while (colour < kColours && (taken[colour / 64] >> (colour % 64) & 1)) ++colour;
    if (colour == kColours) {
      serial.push_back(p);
      continue;
    }
    for (Id c : cells) used[c][colour / 64] |= std::uint64_t(1) << (colour % 64);
    if (static_cast<int>(groups.size()) <= colour) groups.resize(colour + 1);
    groups[colour].push_back(p);
  }
  for (Id p : serial) groups.push_back({p});
  return groups;
}

}  // namespace pm
