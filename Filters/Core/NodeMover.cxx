// SPDX-License-Identifier: BSD-3-Clause
#include "NodeMover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "FoamQuality.h"

namespace pm {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr std::size_t kMostCorners = 96;  // of a cell's faces together; a hexahedron has 24

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

const char* describe(Refusal refusal) {
  switch (refusal) {
    case Refusal::None:
      return "nothing";
    case Refusal::Eta:
      return "degradation of a face";
    case Refusal::Warpage:
      return "warpage of a face";
    case Refusal::Volume:
      return "volume of a cell";
    case Refusal::CentralTet:
      return "central tetrahedron of a cell";
    case Refusal::FacePyramid:
      return "face pyramid of a cell";
    case Refusal::Determinant:
      return "determinant of a cell";
    case Refusal::Angle:
      return "angle of a face";
    case Refusal::Skewness:
      return "skewness of a face";
    case Refusal::FaceWeight:
      return "weight of a face";
    case Refusal::VolumeRatio:
      return "volume ratio of a face";
    case Refusal::FaceTet:
      return "decomposition tetrahedron of a face";
    case Refusal::Other:
      break;
  }
  return "its neighbours";
}

/// What one attempt touches and how it was before; reused from attempt to attempt, one for each thread.
struct NodeMover::Touched {
  std::vector<Id> shapes;  // faces of the points: their shape changes
  std::vector<Id> cells;   // cells of the points: volume and centre change
  std::vector<Id> faces;   // all faces of those cells: their angle changes
  // As they were; as many as have been touched so far.
  std::vector<FaceMeasures> oldShapes;
  std::vector<CellState> oldCells;
  std::vector<FaceState> oldFaces;
  std::vector<Vec3> oldPoints;
};

NodeMover::NodeMover(PolyMesh& mesh, const QualityLimits& limits, const Monitor* monitor)
    : mesh_(mesh),
      monitor_(monitor),
      limits_(limits),
      cosInternal_(std::cos(limits.maxAngleInternal * kDegree)),
      cosBoundary_(std::cos(limits.maxAngleBoundary * kDegree)),
      cosWarpage_(std::cos(limits.maxWarpage * kDegree)),
      minVolume_(limits.minVolume * std::pow(mesh.finestSize, 3)),
      // A hair above zero, so that no tetrahedron is flat to rounding.
      minTet_(std::max(limits.minTet, 1e-6) * std::pow(mesh.finestSize, 3)),
      // The same for what is kept in single precision.
      minWeight_(limits.minFaceWeight * (1 + 1e-6)),
      minRatio_(limits.minVolumeRatio * (1 + 1e-6)),
      faces_(mesh.faceCount()),
      cells_(mesh.cellCount),
      pointCells_(pointCells(mesh)),
      pointFaces_(pointFaces(mesh)),
      cellFaces_(cellFaces(mesh)),
      cellPoints_(cellPoints(mesh)),
      changed_(mesh.cellCount) {
  tbb::parallel_for(Id(0), mesh.faceCount(),
                    [&](Id f) { faces_[f].shape = measureFace(mesh_.points, mesh_.faces[f]); });
  tbb::parallel_for(Id(0), mesh.cellCount, [&](Id c) { cells_[c] = cellNow(c); });
  tbb::parallel_for(Id(0), mesh.faceCount(), [&](Id f) { relate(f); });
}

NodeMover::CellState NodeMover::cellNow(Id c) const {
  CellState cell;
  measureShape(c, cell);
  cell.determinant = determinant(c);
  return cell;
}

double NodeMover::determinant(Id c) const {
  std::array<Vec3, kMostCorners> areas;
  std::size_t count = 0;
  for (Id f : cellFaces_[c])
    if (isInternal(f) && count < kMostCorners) areas[count++] = faces_[f].shape.normal;
  return cellDeterminant(areas.data(), count);
}

// measureCell() with what is known of the faces already: one cross product for each central triangle.
void NodeMover::measureShape(Id c, CellState& cell) const {
  const Span<Id> faces = cellFaces_[c];
  const auto centreOf = [&](Id f) -> const Vec3& { return faces_[f].shape.centre; };
  std::size_t corners = 0;
  for (Id f : faces) corners += mesh_.faces[f].size();
  if (corners > kMostCorners) {
    static_cast<CellMeasures&>(cell) = measureCell(mesh_, c, faces, cellPoints_[c], centreOf);
    return;
  }

  const Vec3 origin = mesh_.points[cellPoints_[c][0]];
  const double faceCount = static_cast<double>(faces.size());
  Vec3 average = Vec3::Zero(), estimate = Vec3::Zero();
  for (Id p : cellPoints_[c]) average += mesh_.points[p] - origin;
  average /= static_cast<double>(cellPoints_[c].size());
  for (Id f : faces) estimate += centreOf(f) - origin;
  estimate /= faceCount;

  // Central tetrahedra about the average, and OpenFOAM's pyramids about the mean of the face centres.
  std::array<Vec3, kMostCorners> triangles;  // six times the volume of a tetrahedron, per unit of its height
  Vec3 moment = Vec3::Zero(), foamMoment = Vec3::Zero();
  double volume = 0, foamVolume = 0;
  std::size_t k = 0;
  for (Id f : faces) {
    const double sign = mesh_.owner[f] == c ? 1 : -1;
    const Vec3 centre = centreOf(f), at = centre - origin, apex = at - average;
    const double pyramid = sign * faces_[f].shape.normal.dot(at - estimate);
    foamVolume += pyramid;
    foamMoment += pyramid * (0.75 * at + 0.25 * estimate);
    const Span<Id> row = mesh_.faces[f];
    Vec3 a = mesh_.points[row[row.size() - 1]] - centre;
    for (Id p : row) {
      const Vec3 b = mesh_.points[p] - centre;
      triangles[k] = sign * a.cross(b);
      const double tet = triangles[k++].dot(apex) / 6;
      volume += tet;
      moment += tet * (a + b + 3 * apex);
      a = b;
    }
  }
  const Vec3 centre = volume != 0 ? Vec3(average + moment / (4 * volume)) : average;
  const Vec3 foamCentre = foamVolume != 0 ? Vec3(foamMoment / foamVolume) : estimate;
  cell.volume = volume;
  cell.centre = origin + centre;
  cell.foamCentre = origin + foamCentre;
  cell.minTet = cell.minPyramid = std::numeric_limits<double>::infinity();
  k = 0;
  for (Id f : faces) {
    const Vec3 at = centreOf(f) - origin, apex = at - centre;
    const double sign = mesh_.owner[f] == c ? 1 : -1;
    cell.minPyramid = std::min(cell.minPyramid, sign * faces_[f].shape.normal.dot(at - foamCentre) / 3);
    for (std::size_t end = k + mesh_.faces[f].size(); k < end; ++k)
      cell.minTet = std::min(cell.minTet, triangles[k].dot(apex) / 6);
  }
}

// What lies between a face and its cells, from the current centres.
void NodeMover::relate(Id f) {
  FaceState& s = faces_[f];
  const Span<Id> row = mesh_.faces[f];
  const CellMeasures& own = cells_[mesh_.owner[f]];
  if (isInternal(f)) {
    const CellMeasures& next = cells_[mesh_.neighbour[f]];
    s.cosAngle = std::min(cosine(s.shape.normal, next.centre - own.centre),
                          cosine(s.shape.normal, next.foamCentre - own.foamCentre));
    s.skew = internalSkewness(mesh_.points, row, s.shape, own.foamCentre, next.foamCentre);
    s.weight = static_cast<float>(faceWeight(s.shape, own.foamCentre, next.foamCentre));
    s.volumeRatio = static_cast<float>(pm::volumeRatio(own.volume, next.volume));
    s.tet = static_cast<float>(
        faceTetVolume(mesh_.points, row, s.shape, own.foamCentre, &next.foamCentre, minTet_));
  } else {
    s.cosAngle = cosine(s.shape.normal, s.shape.centre - own.centre);
    s.skew = boundarySkewness(mesh_.points, row, s.shape, own.foamCentre);
    s.tet = static_cast<float>(faceTetVolume(mesh_.points, row, s.shape, own.foamCentre, nullptr, minTet_));
  }
}

Refusal NodeMover::shapeRefuses(Id f, const FaceMeasures& old) const {
  const FaceMeasures& now = faces_[f].shape;
  const double minEta = isInternal(f) ? limits_.minEtaInternal : limits_.minEtaBoundary;
  if (!(now.eta >= minEta || now.eta >= old.eta)) return Refusal::Eta;
  if (!(now.cosWarpage >= cosWarpage_ || now.cosWarpage >= old.cosWarpage)) return Refusal::Warpage;
  return Refusal::None;
}

Refusal NodeMover::angleRefuses(Id f, const FaceState& old) const {
  const FaceState& now = faces_[f];
  const bool internal = isInternal(f);
  const double minCos = internal ? cosInternal_ : cosBoundary_;
  const double maxSkew = internal ? limits_.maxSkewInternal : limits_.maxSkewBoundary;
  if (!(now.cosAngle >= minCos || now.cosAngle >= old.cosAngle)) return Refusal::Angle;
  if (!(now.skew <= maxSkew || now.skew <= old.skew)) return Refusal::Skewness;
  if (!(now.weight >= minWeight_ || now.weight >= old.weight)) return Refusal::FaceWeight;
  if (!(now.volumeRatio >= minRatio_ || now.volumeRatio >= old.volumeRatio)) return Refusal::VolumeRatio;
  if (!(now.tet >= minTet_ || now.tet >= old.tet)) return Refusal::FaceTet;
  return Refusal::None;
}

Refusal NodeMover::cellRefuses(const CellState& now, const CellState& old) const {
  if (!(now.volume >= minVolume_ || now.volume >= old.volume)) return Refusal::Volume;
  if (!(now.minTet >= minTet_ || now.minTet >= old.minTet)) return Refusal::CentralTet;
  if (!(now.minPyramid >= minTet_ || now.minPyramid >= old.minPyramid)) return Refusal::FacePyramid;
  if (!(now.determinant >= limits_.minDeterminant || now.determinant >= old.determinant))
    return Refusal::Determinant;
  return Refusal::None;
}

double NodeMover::badnessOfShape(const FaceMeasures& shape, bool internal) const {
  const double eta = internal ? limits_.minEtaInternal : limits_.minEtaBoundary;
  return std::max((1 - shape.cosWarpage) / (1 - cosWarpage_), (1 - shape.eta) / (1 - eta));
}

double NodeMover::badnessOfAngle(const FaceState& s, bool internal) const {
  const double cosine = internal ? cosInternal_ : cosBoundary_;
  const double skew = internal ? limits_.maxSkewInternal : limits_.maxSkewBoundary;
  return std::max((1 - s.cosAngle) / (1 - cosine), s.skew / skew);
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
    for (Id f : cellFaces_[c]) worst = std::max(worst, badnessOfFace(faces_[f], isInternal(f)));
  }
  return worst;
}

void NodeMover::gather(const Id* points, std::size_t count, Touched& t) const {
  t.shapes.clear(), t.cells.clear(), t.faces.clear();
  t.oldShapes.clear(), t.oldCells.clear(), t.oldFaces.clear();
  for (std::size_t i = 0; i < count; ++i) {
    for (Id f : pointFaces_[points[i]]) t.shapes.push_back(f);
    for (Id c : pointCells_[points[i]]) t.cells.push_back(c);
  }
  if (count > 1) {
    sortUnique(t.shapes);
    sortUnique(t.cells);
  }
}

// The worst measure got better; or it stayed (two faces of a symmetric prism share it) and what is over the
// limits shrank.
bool NodeMover::isBetter(const Touched& t) const {
  double before = 0, after = 0, excessBefore = 0, excessAfter = 0;
  const auto add = [](double badness, double& worst, double& excess) {
    worst = std::max(worst, badness);
    excess += std::max(0.0, badness - 1);
  };
  std::size_t k = 0;  // both lists ascend, and the faces hold the shapes
  for (std::size_t i = 0; i < t.faces.size(); ++i) {
    const bool internal = t.faces[i] < mesh_.internalFaces();
    FaceState old = t.oldFaces[i];
    if (k < t.shapes.size() && t.shapes[k] == t.faces[i]) old.shape = t.oldShapes[k++];
    add(badnessOfFace(old, internal), before, excessBefore);
    add(badnessOfFace(faces_[t.faces[i]], internal), after, excessAfter);
  }
  for (std::size_t i = 0; i < t.cells.size(); ++i) {
    add(badnessOfCell(t.oldCells[i]), before, excessBefore);
    add(badnessOfCell(cells_[t.cells[i]]), after, excessAfter);
  }
  return after < before || (after == before && excessAfter < excessBefore);
}

// Cheapest checks first; each notes what it changes, and ends the attempt at the first measure that is out of
// its limit or worse than `worst`.
Refusal NodeMover::tryShapes(Touched& t, double worst) {
  for (Id f : t.shapes) {
    t.oldShapes.push_back(faces_[f].shape);
    faces_[f].shape = measureFace(mesh_.points, mesh_.faces[f]);
    if (const Refusal r = shapeRefuses(f, t.oldShapes.back()); r != Refusal::None) return r;
    if (worst < kAny && badnessOfShape(faces_[f].shape, isInternal(f)) > worst) return Refusal::Other;
  }
  return Refusal::None;
}

Refusal NodeMover::tryCells(Touched& t, double worst) {
  for (Id c : t.cells) {
    t.oldCells.push_back(cells_[c]);
    cells_[c] = cellNow(c);
    if (const Refusal r = cellRefuses(cells_[c], t.oldCells.back()); r != Refusal::None) return r;
    if (worst < kAny && badnessOfCell(cells_[c]) > worst) return Refusal::Other;
  }
  return Refusal::None;
}

Refusal NodeMover::tryAngles(Touched& t, double worst) {
  for (Id c : t.cells)
    for (Id f : cellFaces_[c]) t.faces.push_back(f);
  sortUnique(t.faces);
  for (Id f : t.faces) {
    t.oldFaces.push_back(faces_[f]);
    relate(f);
    if (const Refusal r = angleRefuses(f, t.oldFaces.back()); r != Refusal::None) return r;
    if (worst < kAny && badnessOfAngle(faces_[f], isInternal(f)) > worst) return Refusal::Other;
  }
  return Refusal::None;
}

void NodeMover::undo(const Id* points, const Touched& t) {
  for (std::size_t i = 0; i < t.oldPoints.size(); ++i) mesh_.points[points[i]] = t.oldPoints[i];
  for (std::size_t i = 0; i < t.oldFaces.size(); ++i) faces_[t.faces[i]] = t.oldFaces[i];
  for (std::size_t i = 0; i < t.oldShapes.size(); ++i) faces_[t.shapes[i]].shape = t.oldShapes[i];
  for (std::size_t i = 0; i < t.oldCells.size(); ++i) cells_[t.cells[i]] = t.oldCells[i];
}

Refusal NodeMover::attempt(const Id* points, const Vec3* targets, std::size_t count, double worst,
                           const std::function<bool()>& accept) {
  const bool mustImprove = worst < kAny;
  thread_local Touched t;
  t.oldPoints.clear();
  bool moves = false;
  const auto forEachFree = [&](const auto& body) {
    for (std::size_t i = 0; i < count; ++i)
      for (int a = 0; a < 3; ++a)
        if (!(mesh_.fixed[points[i]] >> a & 1)) body(mesh_.points[points[i]][a], targets[i][a]);
  };
  for (std::size_t i = 0; i < count; ++i) t.oldPoints.push_back(mesh_.points[points[i]]);
  forEachFree([&](double x, double to) { moves = moves || x != to; });
  if (!moves) return !mustImprove && (!accept || accept()) ? Refusal::None : Refusal::Other;
  gather(points, count, t);
  forEachFree([&](double& x, double to) { x = to; });
  Refusal refusal = tryShapes(t, worst);
  if (refusal == Refusal::None && accept && !accept()) refusal = Refusal::Other;
  if (refusal == Refusal::None) refusal = tryCells(t, worst);
  if (refusal == Refusal::None) refusal = tryAngles(t, worst);
  if (refusal == Refusal::None && mustImprove && !isBetter(t)) refusal = Refusal::Other;
  if (refusal != Refusal::None) {
    undo(points, t);
    return refusal;
  }
  for (Id f : t.faces) {
    changed_[mesh_.owner[f]].store(tick_, std::memory_order_relaxed);
    if (f < mesh_.internalFaces()) changed_[mesh_.neighbour[f]].store(tick_, std::memory_order_relaxed);
  }
  return Refusal::None;
}

Id NodeMover::lastChange(Id p) const {
  Id last = 0;
  const auto look = [&](Id point) {
    for (Id c : pointCells_[point]) last = std::max(last, changed_[c].load(std::memory_order_relaxed));
  };
  look(p);
  if (mesh_.base[p] != kNone) look(mesh_.base[p]);
  return last;
}

bool NodeMover::improveTogether(const std::vector<Id>& points, const std::vector<Vec3>& targets) {
  double worst = 0;
  for (Id p : points) worst = std::max(worst, badness(p));
  return attempt(points.data(), targets.data(), points.size(), worst) == Refusal::None;
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
  std::vector<Id> slotOf(mesh_.cellCount, kNone);  // of the cells that have a colour
  std::vector<Mask> used;
  std::vector<std::vector<Id>> groups;
  std::vector<Id> cells, serial;
  for (Id p : points) {
    cells.assign(pointCells_[p].begin(), pointCells_[p].end());
    if (mesh_.base[p] != kNone)
      cells.insert(cells.end(), pointCells_[mesh_.base[p]].begin(), pointCells_[mesh_.base[p]].end());
    Mask taken{};
    const auto take = [&](Id c) {
      if (slotOf[c] == kNone) return;
      for (int w = 0; w < kWords; ++w) taken[w] |= used[slotOf[c]][w];
    };
    for (Id c : cells)
      for (Id f : cellFaces_[c]) {
        take(mesh_.owner[f]);
        if (f < mesh_.internalFaces()) take(mesh_.neighbour[f]);
      }
    int colour = 0;
    while (colour < kColours && (taken[colour / 64] >> (colour % 64) & 1)) ++colour;
    if (colour == kColours) {
      serial.push_back(p);
      continue;
    }
    for (Id c : cells) {
      if (slotOf[c] == kNone) {
        slotOf[c] = static_cast<Id>(used.size());
        used.push_back({});
      }
      used[slotOf[c]][colour / 64] |= std::uint64_t(1) << (colour % 64);
    }
    if (static_cast<int>(groups.size()) <= colour) groups.resize(colour + 1);
    groups[colour].push_back(p);
  }
  for (Id p : serial) groups.push_back({p});
  return groups;
}

}  // namespace pm
