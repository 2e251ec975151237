// SPDX-License-Identifier: BSD-3-Clause
// Lookup on feature curves; FeatureEdges.h describes it.
#include <algorithm>

#include "Bvh.h"
#include "ClosestPoint.h"
#include "FeatureEdges.h"

namespace pm {

namespace {

Box boxOf(const FeatureSegment& s) {
  Box box;
  box.add(s.a);
  box.add(s.b);
  return box;
}

Bvh bvhOver(const std::vector<FeatureSegment>& segments, Id begin, Id end) {
  std::vector<Box> boxes;
  boxes.reserve(end - begin);
  for (Id s = begin; s < end; ++s) boxes.push_back(boxOf(segments[s]));
  return Bvh(boxes);
}

/// Closest of the segments first + bvh item; best may hold a first bound.
void search(const Bvh& bvh, const std::vector<FeatureSegment>& segments, Id first, const Vec3& p,
            double bound2, ClosestOnFeature& best) {
  const auto limit = [&] { return std::min(bound2, best.distance2); };
  bvh.nearest(p, limit, [&](Id slot) {
    ClosestOnFeature found;
    found.segment = first + bvh.order()[slot];
    closestOnEdge(p, segments[found.segment].a, segments[found.segment].b, found);
    if (found.distance2 > bound2) return;
    if (found.distance2 < best.distance2 ||
        (found.distance2 == best.distance2 && found.segment < best.segment))
      best = found;
  });
}

}  // namespace

struct FeatureGraph::Index {
  Bvh all;
  std::vector<Bvh> ofCurve;
};

double FeatureCurve::length() const {
  double sum = 0;
  for (std::size_t i = 1; i < points.size(); ++i) sum += (points[i] - points[i - 1]).norm();
  if (closed && !points.empty()) sum += (points.front() - points.back()).norm();
  return sum;
}

FeatureGraph::FeatureGraph(std::vector<Vec3> corners, std::vector<FeatureCurve> curves,
                           std::vector<FeatureSegment> segments)
    : corners_(std::move(corners)),
      curves_(std::move(curves)),
      segments_(std::move(segments)),
      firstSegment_(curves_.size() + 1, 0),
      index_(std::make_unique<Index>()) {
  Id previous = 0;
  for (const FeatureSegment& s : segments_) {
    if (s.curve < previous || s.curve >= static_cast<Id>(curves_.size()))
      throw InternalError("The segments of feature curves are not in the order of the curves.");
    previous = s.curve;
    ++firstSegment_[s.curve + 1];
  }
  for (std::size_t c = 0; c < curves_.size(); ++c) firstSegment_[c + 1] += firstSegment_[c];
  index_->all = bvhOver(segments_, 0, static_cast<Id>(segments_.size()));
  index_->ofCurve.reserve(curves_.size());
  for (std::size_t c = 0; c < curves_.size(); ++c)
    index_->ofCurve.push_back(bvhOver(segments_, firstSegment_[c], firstSegment_[c + 1]));
}

FeatureGraph::~FeatureGraph() = default;
FeatureGraph::FeatureGraph(FeatureGraph&&) noexcept = default;
FeatureGraph& FeatureGraph::operator=(FeatureGraph&&) noexcept = default;

ClosestOnFeature FeatureGraph::closest(const Vec3& p, double maxDistance) const {
  ClosestOnFeature best;
  search(index_->all, segments_, 0, p, maxDistance * maxDistance, best);
  return best;
}

ClosestOnFeature FeatureGraph::closestOnCurve(const Vec3& p, Id curve) const {
  ClosestOnFeature best;
  search(index_->ofCurve[curve], segments_, firstSegment_[curve], p, best.distance2, best);
  return best;
}

std::vector<Id> FeatureGraph::segmentsNear(const Box& box) const {
  std::vector<Id> found;
  index_->all.overlapping(box, [&](Id slot) {
    const Id s = index_->all.order()[slot];
    if (boxOf(segments_[s]).overlaps(box)) found.push_back(s);
  });
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace pm
