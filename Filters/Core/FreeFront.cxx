// SPDX-License-Identifier: BSD-3-Clause
#include "FreeFront.h"

#include <tbb/parallel_for.h>

#include "MeshQuality.h"

namespace pm {
namespace {

// The first sweeps flatten the front's stairs: a riser has to lie down in the surface, and folds if it is
// still upright when it gets there. The way is spread over the others, so that all parts arrive together.
constexpr int kFlatteningSweeps = 3, kDriftingSweeps = 6;
constexpr double kStep = 0.5;  // of the way to the middle of the faces around

class FreeFront {
 public:
  FreeFront(const PolyMesh& mesh, const WallSurface& wall) : mesh_(mesh), wall_(wall) {
    for (Id p : wall.nodes) place_.push_back(mesh.points[p]);
    next_ = place_;
    slot_.assign(mesh.boundaryFaces(), kNone);
    std::vector<Id> rows;
    for (Id b = 0; b < mesh.boundaryFaces(); ++b) {
      if (!mesh.isWallPatch(mesh.patch[b])) continue;
      slot_[b] = faces_.rows();
      rows.clear();
      for (Id p : mesh.faces[mesh.internalFaces() + b]) rows.push_back(wall.rowOf[p]);
      faces_.push(rows);
    }
    shapes_.resize(faces_.rows());
  }

  /// Each node goes to where goal(row, middle, normal) says, all at once: given the middle of the faces
  /// around it, relative to it and weighted by area, and their outward unit normal.
  template <class Goal>
  void sweep(const Goal& goal) {
    tbb::parallel_for(Id(0), faces_.rows(), [&](Id f) { shapes_[f] = measureFace(place_, faces_[f], true); });
    tbb::parallel_for(Id(0), wall_.size(), [&](Id row) {
      const auto shape = [&](Id f) -> const FaceMeasures& {
        return shapes_[slot_[f - mesh_.internalFaces()]];
      };
      const FacesAround around = facesAround(
          wall_.faces[row], place_[row], [&](Id f) { return shape(f).centre; },
          [&](Id f) { return shape(f).normal; });
      next_[row] = goal(row, around.middle, Vec3(around.normal.stableNormalized()));
      for (int a = 0; a < 3; ++a)
        if (mesh_.fixed[wall_.nodes[row]] >> a & 1) next_[row][a] = place_[row][a];
    });
    place_.swap(next_);
  }

  const std::vector<Vec3>& places() const { return place_; }

 private:
  const PolyMesh& mesh_;
  const WallSurface& wall_;
  std::vector<Vec3> place_, next_;  // #W
  Csr<Id> faces_;                   // wall faces by rows of the wall
  std::vector<Id> slot_;            // #boundary faces: row in faces_
  std::vector<FaceMeasures> shapes_;
};

}  // namespace

std::vector<Vec3> freeFront(const PolyMesh& mesh, const WallSurface& wall, const WayToGeometry& way,
                            Monitor& monitor) {
  constexpr double kSweeps = kFlatteningSweeps + kDriftingSweeps;
  FreeFront front(mesh, wall);
  for (int k = 0; k < kFlatteningSweeps; ++k) {
    monitor.check(k / kSweeps, "front smoothing");
    front.sweep([&](Id row, const Vec3& middle, const Vec3&) -> Vec3 {
      return front.places()[row] + kStep * middle;
    });
  }
  for (int left = kDriftingSweeps; left > 0; --left) {
    monitor.check(1 - left / kSweeps, "front smoothing");
    front.sweep([&](Id row, const Vec3& middle, const Vec3& n) -> Vec3 {
      const Vec3 along = front.places()[row] + kStep * (middle - middle.dot(n) * n);
      return along + way(row, along) / left;
    });
  }
  return front.places();
}

}  // namespace pm
