// SPDX-License-Identifier: BSD-3-Clause
#include "FittingCuts.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pm {
namespace {

// In finest cells: from where on a face is off the geometry. And the share of its distance that a cut may
// leave.
constexpr double kOff = 0.05, kMostLeft = 0.7;
// Cosine of 20 degrees: faces whose parts would not bend by that much only have the chord error of a smooth
// surface, and without a cut the prisms below take more layers.
constexpr double kFolds = 0.94;

class CutChooser {
 public:
  CutChooser(const NodeMover& mover, const DistanceField& field)
      : mover_(mover), mesh_(mover.mesh()), field_(field) {}

  /// Would the face that the two are together be cut where they meet?
  bool wouldCut(const WallMerge& pair) const {
    const std::vector<Id> row = mergedRow(mesh_.faces[pair.first], mesh_.faces[pair.second], pair.a, pair.b);
    const Span<Id> ring{row.data(), row.data() + row.size()};
    const double now = distance(measureFace(mesh_.points, ring, true).centre);
    return now >= kOff * mesh_.finestSize &&
           distanceWith(ring, pair.a, pair.b, kMostLeft * now) < kMostLeft * now;
  }

  WallCut choose(Id face) const {
    const Span<Id> row = mesh_.faces[face];
    const std::size_t n = row.size();
    WallCut best;
    if (n < 4) return best;
    const double now = distance(mover_.faceCentre(face));
    if (now < kOff * mesh_.finestSize) return best;
    double least = kMostLeft * now;
    for (std::size_t i = 0; i + 2 < n; ++i)
      for (std::size_t j = i + 2; j < n && j < i + n - 1; ++j) {
        const double left = distanceWith(row, row[i], row[j], least);
        if (left >= least || !mover_.cutHolds({face, row[i], row[j]})) continue;
        least = left;
        best = {face, row[i], row[j]};
      }
    return best;
  }

 private:
  double distance(const Vec3& p) const { return std::sqrt(field_.closest(p).distance2); }
  /// Of the parts' centres and the middle of the cut; infinite when the face does not fold there.
  double distanceWith(Span<Id> row, Id a, Id b, double enough) const {
    std::vector<Id> rows[2];
    cutRow(row, a, b, rows[0], rows[1]);
    FaceMeasures parts[2];
    for (int i : {0, 1})
      parts[i] = measureFace(mesh_.points, {rows[i].data(), rows[i].data() + rows[i].size()}, true);
    if (parts[0].normal.stableNormalized().dot(parts[1].normal.stableNormalized()) > kFolds)
      return std::numeric_limits<double>::infinity();
    double worst = distance(0.5 * (mesh_.points[a] + mesh_.points[b]));
    for (const FaceMeasures& part : parts)
      if (worst < enough) worst = std::max(worst, distance(part.centre));
    return worst;
  }

  const NodeMover& mover_;
  const PolyMesh& mesh_;
  const DistanceField& field_;
};

/// Is one of the cells beside the faces marked?
bool isBeside(const PolyMesh& mesh, Span<Id> faces, const std::vector<char>& marked) {
  return std::any_of(faces.begin(), faces.end(), [&](Id f) {
    return marked[mesh.owner[f]] || (f < mesh.internalFaces() && marked[mesh.neighbour[f]]);
  });
}

}  // namespace

std::vector<WallCut> fittingCuts(const NodeMover& mover, const DistanceField& field) {
  const PolyMesh& mesh = mover.mesh();
  const CutChooser chooser(mover, field);
  std::vector<WallCut> cuts(mesh.boundaryFaces());
  tbb::parallel_for(Id(0), mesh.boundaryFaces(), [&](Id b) {
    if (mesh.isWallPatch(mesh.patch[b])) cuts[b] = chooser.choose(mesh.internalFaces() + b);
  });
  cuts.erase(std::remove_if(cuts.begin(), cuts.end(), [](const WallCut& c) { return c.face == kNone; }),
             cuts.end());
  return cuts;
}

std::vector<WallMerge> needlessCuts(const NodeMover& mover, const DistanceField& field,
                                    const std::function<bool(Id, Id)>& isOnFeature) {
  const PolyMesh& mesh = mover.mesh();
  const CutChooser chooser(mover, field);
  const std::vector<WallMerge> pairs = wallPairs(mesh);
  std::vector<char> needless(pairs.size(), 0);
  tbb::parallel_for(std::size_t(0), pairs.size(), [&](std::size_t i) {
    needless[i] =
        !isOnFeature(pairs[i].a, pairs[i].b) && !chooser.wouldCut(pairs[i]) && mover.mergeHolds(pairs[i]);
  });
  std::vector<char> merged(mesh.cellCount, 0);
  std::vector<WallMerge> merges;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Id c = mesh.owner[pairs[i].first];
    if (!needless[i] || isBeside(mesh, mover.facesOfCell(c), merged)) continue;
    merged[c] = 1;
    merges.push_back(pairs[i]);
  }
  return merges;
}

std::vector<WallMerge> cutsToUndo(const NodeMover& mover, const std::vector<WallCut>& cuts) {
  using Edge = std::pair<Id, Id>;
  std::vector<Edge> broken;
  for (const WallCut& c : cuts)
    if (!mover.holdsAround(c.a) || !mover.holdsAround(c.b)) broken.push_back(std::minmax(c.a, c.b));
  if (broken.empty()) return {};
  std::sort(broken.begin(), broken.end());
  std::vector<WallMerge> undo;
  for (const WallMerge& pair : wallPairs(mover.mesh()))
    if (std::binary_search(broken.begin(), broken.end(), Edge(std::minmax(pair.a, pair.b))))
      undo.push_back(pair);
  return undo;
}

}  // namespace pm
