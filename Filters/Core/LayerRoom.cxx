// SPDX-License-Identifier: BSD-3-Clause
#include "LayerRoom.h"

#include <algorithm>

#include "NodeMover.h"

namespace pm {
namespace {

constexpr int kRounds = 4, kHalvings = 3;
constexpr double kGoodSight = 0.4;    // of the best there is: an edge with more is left as it leans
constexpr double kLongEnough = 0.99;  // of the wanted length

class RoomMaker {
 public:
  RoomMaker(PolyMesh& mesh, const LayerColumns& columns, const WallSight& sight,
            const std::vector<double>& wanted)
      : mesh_(mesh), columns_(columns), sight_(sight), wanted_(wanted) {}

  void run(const QualityLimits& limits, Monitor& monitor) {
    std::vector<Id> ends = lacking();
    if (ends.empty()) return;
    const Csr<Id> faces = pointFaces(mesh_);
    std::vector<Id> movable = ends, below = pointsBelow(ends, faces);
    movable.insert(movable.end(), below.begin(), below.end());
    NodeMover mover(mesh_, limits, movable, &monitor);
    mover.forEach(mover.colour(ends), [&](Id b) { stretch(mover, b); });
    // Edges that only lean are as upright as they get now; for length others must give way, too.
    for (int round = 1; round < kRounds; ++round) {
      ends.erase(std::remove_if(ends.begin(), ends.end(), [&](Id b) { return !isShort(b); }), ends.end());
      if (ends.empty()) return;
      below = pointsBelow(ends, faces);
      mover.forEach(mover.colour(below), [&](Id p) { mover.improve(p, evened(mover, p)); });
      mover.forEach(mover.colour(ends), [&](Id b) { stretch(mover, b); });
    }
  }

 private:
  Vec3 edge(Id b) const { return mesh_.points[b] - mesh_.points[columns_.wallPoint(b)]; }
  bool leans(Id b) const {
    const Id p = columns_.wallPoint(b);
    return sight_.cosine(p, edge(b)) < kGoodSight * sight_.bestCosine(p);
  }
  bool isShort(Id b) const { return edge(b).norm() < kLongEnough * wanted_[b]; }

  /// Edges that lean or are short, but for those that share their wall point with another.
  std::vector<Id> lacking() const {
    std::vector<Id> list, edges(mesh_.points.size(), 0);
    const Id points = static_cast<Id>(mesh_.points.size());
    for (Id b = 0; b < points; ++b)
      if (columns_.wallPoint(b) >= 0) ++edges[columns_.wallPoint(b)];
    for (Id b = 0; b < points; ++b)
      if (columns_.wallPoint(b) >= 0 && edges[columns_.wallPoint(b)] == 1 && (leans(b) || isShort(b)))
        list.push_back(b);
    return list;
  }
  /// Points of the faces around the lower ends that are neither on the wall nor lower ends themselves.
  std::vector<Id> pointsBelow(const std::vector<Id>& lowerEnds, const Csr<Id>& faces) const {
    std::vector<Id> below;
    for (Id b : lowerEnds)
      for (Id f : faces[b])
        for (Id p : mesh_.faces[f])
          if (mesh_.base[p] == kNone && columns_.wallPoint(p) < 0) below.push_back(p);
    sortUnique(below);
    return below;
  }
  Vec3 evened(const NodeMover& mover, Id p) const { return 0.5 * (mesh_.points[p] + mover.neighbourMean(p)); }
  /// As far as it goes towards the place where the edge is upright and long enough.
  void stretch(NodeMover& mover, Id b) const {
    if (!leans(b) && !isShort(b)) return;
    const Id p = columns_.wallPoint(b);
    const Vec3 e = edge(b);
    const Vec3 direction = leans(b) ? sight_.best(p) : Vec3(e.normalized());
    mover.drift(b, mesh_.points[p] + std::max(e.norm(), wanted_[b]) * direction, kHalvings);
  }

  PolyMesh& mesh_;
  const LayerColumns& columns_;
  const WallSight& sight_;
  const std::vector<double>& wanted_;
};

}  // namespace

void makeLayerRoom(PolyMesh& mesh, const LayerColumns& columns, const WallSight& sight,
                   const std::vector<double>& wanted, const QualityLimits& limits, Monitor& monitor) {
  monitor.check(0.05, "making room for layers");
  RoomMaker(mesh, columns, sight, wanted).run(limits, monitor);
}

}  // namespace pm
