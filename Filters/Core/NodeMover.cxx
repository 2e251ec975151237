// SPDX-License-Identifier: BSD-3-Clause
#include "NodeMover.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "FoamQuality.h"
#include "MoverMeasures.h"

namespace pm {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

/// In single precision, but on the side of the limit where it is: what keeps a limit never seems to break it,
/// nor the other way round. For a value with a lower limit.
float rounded(double value, double limit) {
  const float near = static_cast<float>(value);
  if ((near >= limit) == (value >= limit)) return near;
  constexpr float infinity = std::numeric_limits<float>::infinity();
  return std::nextafter(near, value >= limit ? infinity : -infinity);
}

/// Such a value within its limit or no worse than before.
bool holds(float now, double limit, float before) { return now >= limit || now >= before; }

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
    case Refusal::NotMovable:
      return "not a point that may move";
    case Refusal::Other:
      break;
  }
  return "its neighbours";
}

NodeMover::NodeMover(PolyMesh& mesh, const QualityLimits& limits, MoverRegion region, const Monitor* monitor)
    : mesh_(mesh),
      monitor_(monitor),
      limits_(limits),
      cosInternal_(std::cos(limits.maxAngleInternal * kDegree)),
      cosBoundary_(std::cos(limits.maxAngleBoundary * kDegree)),
      cosWarpage_(std::cos(limits.maxWarpage * kDegree)),
      minVolume_(limits.minVolume * std::pow(mesh.finestSize, 3)),
      // A hair above zero, so that no tetrahedron is flat to rounding.
      minTet_(std::max(limits.minTet, 1e-6) * std::pow(mesh.finestSize, 3)),
      region_(std::move(region)),
      cells_(region_.cellsAndRim),
      changed_(region_.cells) {
  faces_.reserve(region_.faces +
                 region_.faces / 16);  // unused room costs nothing; later growth would copy all
  faces_.resize(region_.faces);
  const auto forEachFace = [&](const auto& body) {
    tbb::parallel_for(Id(0), mesh_.faceCount(), [&](Id f) {
      if (region_.faceSlot[f] != kNone) body(f, face(f));
    });
  };
  forEachFace([&](Id f, Shape& s) { s = shapeNow(f); });
  tbb::parallel_for(Id(0), mesh_.cellCount, [&](Id c) {
    if (region_.isInner(c)) cell(c) = cellNow(c);
  });
  measureRim();
  forEachFace([&](Id f, Relation& s) { s = relationNow(f); });
}

void NodeMover::wallFacesChanged(const std::vector<Id>& cells) {
  region_.renewBoundary(mesh_);
  faces_.resize(region_.faces);  // those of internal faces stay
  const auto forEachBoundaryFace = [&](const auto& body) {
    tbb::parallel_for(mesh_.internalFaces(), mesh_.faceCount(), [&](Id f) {
      if (region_.faceSlot[f] != kNone) body(f, face(f));
    });
  };
  forEachBoundaryFace([&](Id f, Shape& s) { s = shapeNow(f); });
  for (Id c : cells)
    if (region_.isInner(c)) cell(c) = cellNow(c);
  forEachBoundaryFace([&](Id f, Relation& s) { s = relationNow(f); });
  for (Id c : cells)
    if (region_.isInner(c))
      for (Id f : facesOfCell(c))
        if (isInternal(f)) static_cast<Relation&>(face(f)) = relationNow(f);
}

// The rim's other faces have no slots.
void NodeMover::measureRim() {
  const Csr<Id> rimFaces = facesOfSlots(mesh_, region_.cellSlot, region_.cells, region_.cellsAndRim);
  const Csr<Id> rimPoints = pointsOfRows(mesh_, rimFaces);
  tbb::parallel_for(Id(0), mesh_.cellCount, [&](Id c) {
    const Id row = region_.cellSlot[c] - region_.cells;
    if (row < 0) return;
    std::vector<FaceMeasures> shapes;
    std::vector<CellFace> faces;
    for (Id f : rimFaces[row]) shapes.push_back(measureFace(mesh_.points, mesh_.faces[f], true));
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      const Id f = rimFaces[row][k];
      faces.push_back(
          {mesh_.faces[f], &shapes[k].centre, &shapes[k].normal, mesh_.owner[f] == c ? 1.0 : -1.0});
    }
    static_cast<CellMeasures&>(cell(c)) = measureCell(mesh_.points, rimPoints[row], spanOf(faces));
  });
}

NodeMover::CellState NodeMover::cellNow(Id c) const {
  thread_local std::vector<CellFace> faces;
  thread_local std::vector<Vec3> areas;  // of the internal faces
  faces.clear(), areas.clear();
  for (Id f : facesOfCell(c)) {
    const FaceState& s = face(f);
    faces.push_back({mesh_.faces[f], &s.centre, &s.normal, mesh_.owner[f] == c ? 1.0 : -1.0});
    if (isInternal(f)) areas.push_back(s.normal);
  }
  CellState state;
  static_cast<CellMeasures&>(state) = measureCell(mesh_.points, pointsOf(c), spanOf(faces));
  state.determinant = cellDeterminant(areas.data(), areas.size());
  return state;
}

NodeMover::Shape NodeMover::shapeOf(Id f, Span<Id> row) const {
  const FaceMeasures face = measureFace(mesh_.points, row);
  return {face.centre, face.normal, rounded(face.eta, minEta(f)), rounded(face.cosWarpage, cosWarpage_)};
}

NodeMover::Relation NodeMover::relationOf(Id f, Span<Id> row, const Shape& s, const CellMeasures& own,
                                          const CellMeasures* other) const {
  const FaceRelation now = relate(mesh_.points, row, s.centre, s.normal, own, other, minTet_);
  return {rounded(now.cosAngle, minCos(f)), -rounded(-now.skew, -maxSkew(f)),
          rounded(now.weight, limits_.minFaceWeight), rounded(now.volumeRatio, limits_.minVolumeRatio),
          rounded(now.tet, minTet_)};
}

Refusal NodeMover::shapeRefuses(Id f, const Shape& now, const Shape& old) const {
  if (!holds(now.eta, minEta(f), old.eta)) return Refusal::Eta;
  if (!holds(now.cosWarpage, cosWarpage_, old.cosWarpage)) return Refusal::Warpage;
  return Refusal::None;
}

Refusal NodeMover::angleRefuses(Id f, const Relation& now, const Relation& old) const {
  if (!holds(now.cosAngle, minCos(f), old.cosAngle)) return Refusal::Angle;
  if (!holds(-now.skew, -maxSkew(f), -old.skew)) return Refusal::Skewness;
  if (!holds(now.weight, limits_.minFaceWeight, old.weight)) return Refusal::FaceWeight;
  if (!holds(now.volumeRatio, limits_.minVolumeRatio, old.volumeRatio)) return Refusal::VolumeRatio;
  if (!holds(now.tet, minTet_, old.tet)) return Refusal::FaceTet;
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

double NodeMover::badnessOfShape(Id f, const Shape& shape) const {
  return std::max((1.0 - shape.cosWarpage) / (1 - cosWarpage_), (1.0 - shape.eta) / (1 - minEta(f)));
}

double NodeMover::badnessOfRelation(Id f, const Relation& s) const {
  return std::max((1.0 - s.cosAngle) / (1 - minCos(f)), s.skew / maxSkew(f));
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
  for (Id c : cellsOf(p)) {
    worst = std::max(worst, badnessOfCell(cell(c)));
    for (Id f : facesOfCell(c)) worst = std::max(worst, badnessOfRelation(f, face(f)));
  }
  for (Id f : facesOf(p)) worst = std::max(worst, badnessOfShape(f, face(f)));
  return worst;
}

void NodeMover::gather(const Id* points, std::size_t count, Touched& t) const {
  t.shapes.clear(), t.cells.clear(), t.faces.clear();
  t.oldShapes.clear(), t.oldCells.clear(), t.oldRelations.clear();
  for (std::size_t i = 0; i < count; ++i) {
    for (Id f : facesOf(points[i])) t.shapes.push_back(f);
    for (Id c : cellsOf(points[i])) t.cells.push_back(c);
  }
  if (count > 1) {
    sortUnique(t.shapes);
    sortUnique(t.cells);
  }
}

// All faces of the cells; one between two of them is taken with the first.
void NodeMover::gatherFaces(Touched& t) const {
  for (std::size_t i = 0; i < t.cells.size(); ++i)
    for (Id f : facesOfCell(t.cells[i])) {
      const Id own = mesh_.owner[f];
      const Id other = own != t.cells[i] ? own : isInternal(f) ? mesh_.neighbour[f] : kNone;
      const auto before = t.cells.begin() + static_cast<std::ptrdiff_t>(i);
      if (std::find(t.cells.begin(), before, other) == before) t.faces.push_back(f);
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
  for (std::size_t i = 0; i < t.shapes.size(); ++i) {
    add(badnessOfShape(t.shapes[i], t.oldShapes[i]), before, excessBefore);
    add(badnessOfShape(t.shapes[i], face(t.shapes[i])), after, excessAfter);
  }
  for (std::size_t i = 0; i < t.faces.size(); ++i) {
    add(badnessOfRelation(t.faces[i], t.oldRelations[i]), before, excessBefore);
    add(badnessOfRelation(t.faces[i], face(t.faces[i])), after, excessAfter);
  }
  for (std::size_t i = 0; i < t.cells.size(); ++i) {
    add(badnessOfCell(t.oldCells[i]), before, excessBefore);
    add(badnessOfCell(cell(t.cells[i])), after, excessAfter);
  }
  return after < before || (after == before && excessAfter < excessBefore);
}

// Cheapest checks first; each notes what it changes, and ends the attempt at the first measure that is out of
// its limit or worse than `worst`.
Refusal NodeMover::tryShapes(Touched& t, double worst) {
  for (Id f : t.shapes) {
    Shape& shape = face(f);
    t.oldShapes.push_back(shape);
    shape = shapeNow(f);
    if (const Refusal r = shapeRefuses(f, shape, t.oldShapes.back()); r != Refusal::None) return r;
    if (worst < kAny && badnessOfShape(f, shape) > worst) return Refusal::Other;
  }
  return Refusal::None;
}

Refusal NodeMover::tryCells(Touched& t, double worst) {
  for (Id c : t.cells) {
    CellState& state = cell(c);
    t.oldCells.push_back(state);
    state = cellNow(c);
    if (const Refusal r = cellRefuses(state, t.oldCells.back()); r != Refusal::None) return r;
    if (worst < kAny && badnessOfCell(state) > worst) return Refusal::Other;
  }
  return Refusal::None;
}

Refusal NodeMover::tryAngles(Touched& t, double worst) {
  gatherFaces(t);
  for (Id f : t.faces) {
    Relation& s = face(f);
    t.oldRelations.push_back(s);
    s = relationNow(f);
    if (const Refusal r = angleRefuses(f, s, t.oldRelations.back()); r != Refusal::None) return r;
    if (worst < kAny && badnessOfRelation(f, s) > worst) return Refusal::Other;
  }
  return Refusal::None;
}

void NodeMover::undo(const Id* points, const Touched& t) {
  for (std::size_t i = 0; i < t.oldPoints.size(); ++i) mesh_.points[points[i]] = t.oldPoints[i];
  for (std::size_t i = 0; i < t.oldRelations.size(); ++i)
    static_cast<Relation&>(face(t.faces[i])) = t.oldRelations[i];
  for (std::size_t i = 0; i < t.oldShapes.size(); ++i)
    static_cast<Shape&>(face(t.shapes[i])) = t.oldShapes[i];
  for (std::size_t i = 0; i < t.oldCells.size(); ++i) cell(t.cells[i]) = t.oldCells[i];
}

/// Points to where they shall be, but for fixed coordinates.
void NodeMover::place(const Id* points, const Vec3* targets, Touched& t) {
  for (std::size_t i = 0; i < t.oldPoints.size(); ++i)
    for (int a = 0; a < 3; ++a)
      if (!(mesh_.fixed[points[i]] >> a & 1)) mesh_.points[points[i]][a] = targets[i][a];
}

Refusal NodeMover::attempt(const Id* points, const Vec3* targets, std::size_t count, double worst,
                           const std::function<bool()>& accept) {
  const bool mustImprove = worst < kAny;
  for (std::size_t i = 0; i < count; ++i)
    if (!isMovable(points[i])) return Refusal::NotMovable;
  thread_local Touched t;
  t.oldPoints.clear();
  for (std::size_t i = 0; i < count; ++i) t.oldPoints.push_back(mesh_.points[points[i]]);
  place(points, targets, t);
  bool moves = false;
  for (std::size_t i = 0; i < count; ++i) moves = moves || mesh_.points[points[i]] != t.oldPoints[i];
  if (!moves) return !mustImprove && (!accept || accept()) ? Refusal::None : Refusal::Other;
  gather(points, count, t);
  Refusal refusal = tryShapes(t, worst);
  if (refusal == Refusal::None && accept && !accept()) refusal = Refusal::Other;
  if (refusal == Refusal::None) refusal = tryCells(t, worst);
  if (refusal == Refusal::None) refusal = tryAngles(t, worst);
  if (refusal == Refusal::None && mustImprove && !isBetter(t)) refusal = Refusal::Other;
  if (refusal == Refusal::None)
    keep(points, t);
  else
    undo(points, t);
  return refusal;
}

void NodeMover::keep(const Id* points, const Touched& t) {
  for (Id f : t.faces) noteChange(f, tick());
  if (trial_ != nullptr) trial_->entries_.push_back({{points, points + t.oldPoints.size()}, t});
}

/// A point of a face's cell has moved.
void NodeMover::noteChange(Id face, Id tick) {
  const auto note = [&](Id c) {
    const Id slot = region_.cellSlot[c];
    if (slot < region_.cells) changed_[slot].store(tick, std::memory_order_relaxed);
  };
  note(mesh_.owner[face]);
  if (isInternal(face)) note(mesh_.neighbour[face]);
}

Id NodeMover::lastChange(Id p) const {
  Id last = 0;
  const auto look = [&](Id point) {
    for (Id c : cellsOf(point))
      last = std::max(last, changed_[region_.cellSlot[c]].load(std::memory_order_relaxed));
  };
  look(p);
  if (mesh_.base[p] != kNone) look(mesh_.base[p]);
  return last;
}

Vec3 NodeMover::neighbourMean(Id p) const {
  Vec3 sum = Vec3::Zero();
  double count = 0;
  for (Id f : facesOf(p)) {
    const Span<Id> row = mesh_.faces[f];
    const std::size_t k = std::find(row.begin(), row.end(), p) - row.begin(), n = row.size();
    sum += mesh_.points[row[(k + 1) % n]] + mesh_.points[row[(k + n - 1) % n]];
    count += 2;
  }
  return sum / count;
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
  Csr<Id> rows;
  rows.values = points;
  rows.offsets.resize(points.size() + 1);
  std::iota(rows.offsets.begin(), rows.offsets.end(), 0);
  std::vector<std::vector<Id>> groups = groupRows(mesh_, region_, rows);
  for (std::vector<Id>& group : groups)
    for (Id& row : group) row = points[row];
  return groups;
}

}  // namespace pm
