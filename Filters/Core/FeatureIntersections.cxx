// SPDX-License-Identifier: BSD-3-Clause
// Curves along which the surface cuts itself, and those that the user gives, as features; FeatureNetwork.h
// says what is kept.
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "DisjointSets.h"
#include "FeatureNetwork.h"
#include "KnownIntersections.h"

namespace pm {

namespace {

using Links = FeatureNetwork::Links;

/// Links of one source, fitted to those that are there already.
class FittedLinks {
 public:
  FittedLinks(const SurfaceModel& model, const FeatureOptions& options,
              const IntersectionTolerances& tolerances, FeatureNetwork& network)
      : model_(model),
        options_(options),
        tolerance2_(tolerances.joining * tolerances.joining),
        trusted_(tolerances.trusted),
        network_(network) {}

  void addIntersections(std::vector<OpenEdge>& open, Monitor& monitor) {
    chooseIntersections(monitor);
    monitor.check(1, "intersection curves");
    fit(open);
  }
  void addGiven(std::vector<OpenEdge>& open) {
    takeGiven();
    fit(open);
  }

 private:
  const Vec3& at(Id p) const { return network_.points[p]; }

  void fit(std::vector<OpenEdge>& open) {
    if (links_.empty()) return;
    dropCovered();
    dropShort();
    joinToLinks();
    joinToOpenEdges(open);
    network_.links.insert(network_.links.end(), links_.begin(), links_.end());
    unifyLinks(network_.links);
  }

  bool isTrusted(Id t) const {
    const Vec3 &a = model_.corner(t, 0), &b = model_.corner(t, 1), &c = model_.corner(t, 2);
    const double longest =
        std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
    return std::abs((b - a).cross(c - a).dot(model_.normal(t))) > trusted_ * longest;
  }

  bool isSharp(const IntersectionSegment& s) const {
    const double angle = angleBetween(model_.normal(s.a), model_.normal(s.b));
    return std::min(angle, 180 - angle) > options_.sharpAngle;
  }

  /// Sharp segments of trusted triangles, and those of slivers that join two of them.
  void chooseIntersections(Monitor& monitor) {
    const std::shared_ptr<const SelfIntersections> known = knownIntersections(model_, monitor);
    const SelfIntersections& cuts = *known;
    std::vector<std::uint8_t> trusted(cuts.segments.size());
    tbb::parallel_for(std::size_t(0), cuts.segments.size(), [&](std::size_t i) {
      trusted[i] = isTrusted(cuts.segments[i].a) && isTrusted(cuts.segments[i].b);
    });
    std::vector<Id> ids(cuts.points.size(), kNone);  // #P network points
    for (std::size_t i = 0; i < cuts.segments.size(); ++i)
      if (trusted[i] && isSharp(cuts.segments[i])) addLink(cuts, cuts.segments[i], ids);
    const std::vector<Id> sure = ids;
    for (std::size_t i = 0; i < cuts.segments.size(); ++i) {
      const IntersectionSegment& s = cuts.segments[i];
      if (!trusted[i] && sure[s.start] != kNone && sure[s.end] != kNone) addLink(cuts, s, ids);
    }
    unifyLinks(links_);
  }

  /// Points in one place are one, so that polylines join where they meet.
  void takeGiven() {
    std::map<std::array<double, 3>, Id> ids;
    for (const std::vector<Vec3>& line : options_.given) {
      Id last = kNone;
      for (const Vec3& p : line) {
        const auto [it, isNew] = ids.try_emplace({p[0], p[1], p[2]}, static_cast<Id>(network_.points.size()));
        if (isNew) network_.points.push_back(p);
        if (last != kNone && last != it->second)
          links_.push_back({std::min(last, it->second), std::max(last, it->second), kGivenEdge});
        last = it->second;
      }
    }
    unifyLinks(links_);
  }

  void addLink(const SelfIntersections& cuts, const IntersectionSegment& s, std::vector<Id>& ids) {
    for (Id row : {s.start, s.end}) {
      if (ids[row] != kNone) continue;
      const MeetingPoint& name = cuts.names[row];
      ids[row] = name.isCorner() ? name.ids[0] : static_cast<Id>(network_.points.size());
      if (!name.isCorner()) network_.points.push_back(cuts.points[row]);
    }
    const auto [a, b] = std::minmax({ids[s.start], ids[s.end]});
    links_.push_back({a, b, kIntersectionEdge});
  }

  void dropCovered() {
    if (network_.links.empty()) return;
    const LinkLookup firm(network_.points, network_.links);
    std::vector<std::uint8_t> covered(links_.size());
    tbb::parallel_for(std::size_t(0), links_.size(),
                      [&](std::size_t i) { covered[i] = isCovered(links_[i], firm); });
    dropWhere([&](std::size_t i) { return covered[i] != 0; });
  }

  bool isCovered(const FeatureNetwork::Link& link, const LinkLookup& firm) const {
    const Vec3 d = at(link.b) - at(link.a);
    for (const double place : {0.0, 0.25, 0.5, 0.75, 1.0})
      if (!firm.reaches(at(link.a) + place * d, tolerance2_, d)) return false;
    return true;
  }

  /// Connected pieces shorter than the tolerance.
  void dropShort() {
    DisjointSets pieces(network_.points.size());
    for (const auto& link : links_) pieces.join(link.a, link.b);
    std::vector<double> length(network_.points.size(), 0.0);
    for (const auto& link : links_) length[pieces.root(link.a)] += (at(link.b) - at(link.a)).norm();
    const double shortest = std::max(std::sqrt(tolerance2_), options_.shortestCurve);
    dropWhere([&](std::size_t i) { return length[pieces.root(links_[i].a)] < shortest; });
  }

  template <class Predicate>
  void dropWhere(const Predicate& isDropped) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < links_.size(); ++i)
      if (!isDropped(i)) links_[kept++] = links_[i];
    links_.resize(kept);
  }

  /// (number of links, point) of all points of the curves, by point.
  std::vector<std::pair<Id, int>> degrees() const {
    std::vector<Id> ends;
    for (const auto& link : links_) ends.insert(ends.end(), {link.a, link.b});
    std::sort(ends.begin(), ends.end());
    std::vector<std::pair<Id, int>> out;
    for (Id p : ends) {
      if (out.empty() || out.back().first != p) out.push_back({p, 0});
      ++out.back().second;
    }
    return out;
  }

  /// Where a curve meets a link, the link is split there; beside an end of the link the curve's point becomes
  /// it. Free ends of curves look as far as the tolerance, other points only for what they lie on.
  void joinToLinks() {
    if (network_.links.empty()) return;
    const LinkLookup firm(network_.points, network_.links);
    std::vector<std::uint8_t> isFirm(network_.points.size(), 0);
    for (const auto& link : network_.links) isFirm[link.a] = isFirm[link.b] = 1;
    std::vector<Id> becomes(network_.points.size());
    std::iota(becomes.begin(), becomes.end(), 0);
    std::vector<std::pair<Id, Id>> splits;
    std::vector<std::pair<Id, Vec3>> moves;
    for (const auto& [p, degree] : degrees()) {
      if (isFirm[p]) continue;
      const double reach2 = degree == 1 ? tolerance2_ : trusted_ * trusted_;
      const LinkFoot foot = firm.nearest(at(p), reach2);
      if (foot.link == kNone) continue;
      const auto& link = network_.links[foot.link];
      const double toA = (at(link.a) - at(p)).squaredNorm(), toB = (at(link.b) - at(p)).squaredNorm();
      if (std::min(toA, toB) <= reach2) {
        becomes[p] = toA <= toB ? link.a : link.b;
      } else {
        moves.push_back({p, foot.point});
        splits.push_back({foot.link, p});
      }
    }
    for (const auto& [p, to] : moves) network_.points[p] = to;
    splitLinks(network_.points, network_.links, std::move(splits));
    for (auto& link : links_) {
      const auto [a, b] = std::minmax({becomes[link.a], becomes[link.b]});
      link.a = a;
      link.b = b;
    }
    dropWhere([&](std::size_t i) { return links_[i].a == links_[i].b; });
    unifyLinks(links_);
  }

  /// Open edges are split where curves end on them or cross them.
  void joinToOpenEdges(std::vector<OpenEdge>& open) const {
    if (open.empty()) return;
    Links links;
    for (const OpenEdge& e : open) links.push_back({e.a, e.b, kOpenEdge});
    const LinkLookup lookup(network_.points, links);
    std::vector<std::pair<Id, Id>> splits;
    for (const auto& [p, degree] : degrees()) {
      const LinkFoot foot = lookup.nearest(at(p), trusted_ * trusted_);
      if (foot.link != kNone) splits.push_back({foot.link, p});
    }
    splitLinks(network_.points, links, std::move(splits));
    open.clear();
    for (const auto& link : links) open.push_back({link.a, link.b, kNone});
  }

  const SurfaceModel& model_;
  const FeatureOptions& options_;
  const double tolerance2_, trusted_;
  FeatureNetwork& network_;
  Links links_;
};

}  // namespace

void addIntersections(const SurfaceModel& model, const FeatureOptions& options,
                      const IntersectionTolerances& tolerances, FeatureNetwork& network,
                      std::vector<OpenEdge>& open, Monitor& monitor) {
  FittedLinks(model, options, tolerances, network).addIntersections(open, monitor);
}

void addGivenCurves(const SurfaceModel& model, const FeatureOptions& options,
                    const IntersectionTolerances& tolerances, FeatureNetwork& network,
                    std::vector<OpenEdge>& open) {
  FittedLinks(model, options, tolerances, network).addGiven(open);
}

}  // namespace pm
