// SPDX-License-Identifier: BSD-3-Clause
#include "FeatureNetwork.h"

#include <algorithm>
#include <cmath>

#include "ClosestPoint.h"

namespace pm {

namespace {

using Link = FeatureNetwork::Link;
using Links = FeatureNetwork::Links;

Bvh bvhOver(const std::vector<Vec3>& points, const Links& links) {
  std::vector<Box> boxes(links.size());
  for (std::size_t i = 0; i < links.size(); ++i) {
    boxes[i].add(points[links[i].a]);
    boxes[i].add(points[links[i].b]);
  }
  return Bvh(boxes);
}

constexpr double kAlongCosine = 0.866;

/// Pieces of a link between the points of (link, point) rows, in the order of their place along it.
template <class Row>
void appendPieces(const std::vector<Vec3>& points, const Link& link, Row first, Row last, Links& out) {
  const Vec3& a = points[link.a];
  const Vec3 d = points[link.b] - a;
  std::vector<std::pair<double, Id>> places;
  for (; first != last; ++first) places.push_back({(points[first->second] - a).dot(d), first->second});
  std::sort(places.begin(), places.end());
  Id previous = link.a;
  const auto append = [&](Id next) {
    out.push_back({std::min(previous, next), std::max(previous, next), link.kind});
    previous = next;
  };
  for (const auto& [place, p] : places)
    if (place > 0 && place < d.squaredNorm()) append(p);
  append(link.b);
}

}  // namespace

void unifyLinks(Links& links) {
  std::sort(links.begin(), links.end(), [](const Link& x, const Link& y) {
    return x.a != y.a ? x.a < y.a : x.b != y.b ? x.b < y.b : x.kind < y.kind;
  });
  std::size_t kept = 0;
  for (const Link& link : links) {
    if (kept > 0 && links[kept - 1].a == link.a && links[kept - 1].b == link.b)
      links[kept - 1].kind |= link.kind;
    else
      links[kept++] = link;
  }
  links.resize(kept);
}

void splitLinks(const std::vector<Vec3>& points, Links& links, std::vector<std::pair<Id, Id>> splits) {
  sortUnique(splits);
  Links out;
  out.reserve(links.size() + splits.size());
  auto next = splits.begin();
  for (Id i = 0; i < static_cast<Id>(links.size()); ++i) {
    const auto first = next;
    while (next != splits.end() && next->first == i) ++next;
    appendPieces(points, links[i], first, next, out);
  }
  links = std::move(out);
}

LinkLookup::LinkLookup(const std::vector<Vec3>& points, const Links& links)
    : points_(points), links_(links), bvh_(bvhOver(points, links)) {}

bool LinkLookup::isAlong(Id link, const Vec3& direction) const {
  const Vec3 along = points_[links_[link].b] - points_[links_[link].a];
  return std::abs(along.dot(direction)) >= kAlongCosine * direction.norm() * along.norm();
}

LinkFoot LinkLookup::nearest(const Vec3& p, double bound2, const Vec3& direction) const {
  LinkFoot best;
  const auto offer = [&](Id slot) {
    LinkFoot found;
    found.link = bvh_.order()[slot];
    if (!isAlong(found.link, direction)) return;
    closestOnEdge(p, points_[links_[found.link].a], points_[links_[found.link].b], found);
    if (found.distance2 > bound2) return;
    if (found.distance2 < best.distance2 || (found.distance2 == best.distance2 && found.link < best.link))
      best = found;
  };
  bvh_.nearest(
      p, [&] { return std::min(bound2, best.distance2); }, offer);
  return best;
}

bool LinkLookup::reaches(const Vec3& p, double bound2, const Vec3& direction) const {
  bool found = false;
  const auto offer = [&](Id slot) {
    const Id link = bvh_.order()[slot];
    if (found || !isAlong(link, direction)) return;
    LinkFoot foot;
    closestOnEdge(p, points_[links_[link].a], points_[links_[link].b], foot);
    found = foot.distance2 <= bound2;
  };
  bvh_.nearest(
      p, [&] { return found ? -1 : bound2; }, offer);
  return found;
}

}  // namespace pm
