// SPDX-License-Identifier: BSD-3-Clause
// Links of a feature network joined into curves between corners; FeatureNetwork.h describes it.
#include <algorithm>
#include <cmath>

#include "FeatureNetwork.h"

namespace pm {

namespace {

constexpr int kMaxReachSteps = 64;  // bounds the work where points are packed far denser than the reach

/// A walk over links without branches. Closed chains repeat no point.
struct Chain {
  std::vector<Id> points;
  std::vector<std::uint8_t> kinds;  // of the link after each point
  bool closed = false;
};

class CurveBuilder {
 public:
  CurveBuilder(const FeatureNetwork& network, const FeatureOptions& options, double reach)
      : network_(network), options_(options), reach_(reach), visited_(network.links.size(), false) {
    linkRows();
  }

  FeatureGraph run() {
    const Id count = static_cast<Id>(network_.points.size());
    for (Id p = 0; p < count; ++p)
      if (linksOf_[p].size() != 2) walkFrom(p);
    for (Id p = 0; p < count; ++p)
      if (linksOf_[p].size() == 2) walkFrom(p);
    return FeatureGraph(std::move(corners_), std::move(curves_), std::move(segments_));
  }

 private:
  void linkRows() {
    linksOf_.offsets.assign(network_.points.size() + 2, 0);
    for (const auto& link : network_.links)
      for (Id p : {link.a, link.b}) ++linksOf_.offsets[p + 2];
    for (std::size_t i = 2; i < linksOf_.offsets.size(); ++i) linksOf_.offsets[i] += linksOf_.offsets[i - 1];
    linksOf_.values.resize(2 * network_.links.size());
    for (std::size_t i = 0; i < network_.links.size(); ++i)
      for (Id p : {network_.links[i].a, network_.links[i].b})
        linksOf_.values[linksOf_.offsets[p + 1]++] = static_cast<Id>(i);
    linksOf_.offsets.pop_back();
    cornerOf_.assign(network_.points.size(), kNone);
  }

  const Vec3& at(Id p) const { return network_.points[p]; }
  bool isEnd(Id p) const { return linksOf_[p].size() != 2; }

  void walkFrom(Id start) {
    for (Id link : linksOf_[start])
      if (!visited_[link]) addChain(walk(start, link));
  }

  Chain walk(Id start, Id link) {
    Chain chain;
    Id p = start;
    for (;;) {
      visited_[link] = true;
      chain.points.push_back(p);
      chain.kinds.push_back(network_.links[link].kind);
      p = network_.links[link].a == p ? network_.links[link].b : network_.links[link].a;
      if (isEnd(p) || p == start) break;
      link = linksOf_[p][0] == link ? linksOf_[p][1] : linksOf_[p][0];
    }
    chain.closed = !isEnd(start);
    if (!chain.closed) chain.points.push_back(p);
    return chain;
  }

  /// Splits a chain at its turning points and keeps the pieces as curves.
  void addChain(Chain chain) {
    if (isNegligible(chain)) return;
    std::vector<std::size_t> turns = turningPoints(chain);
    if (chain.closed) {
      if (turns.empty()) return addCurve(chain, 0, chain.points.size());
      openAt(chain, turns);
    }
    turns.push_back(chain.points.size() - 1);
    std::size_t begin = 0;
    for (std::size_t end : turns) {
      addCurve(chain, begin, end);
      begin = end;
    }
  }

  /// Makes a loop with corners a chain from its first corner round to the same corner.
  static void openAt(Chain& chain, std::vector<std::size_t>& turns) {
    const std::size_t first = turns.front();
    std::rotate(chain.points.begin(), chain.points.begin() + first, chain.points.end());
    std::rotate(chain.kinds.begin(), chain.kinds.begin() + first, chain.kinds.end());
    const Id corner = chain.points.front();
    chain.points.push_back(corner);
    chain.closed = false;
    turns.erase(turns.begin());
    for (std::size_t& t : turns) t -= first;
  }

  bool isNegligible(const Chain& chain) const {
    if (chain.closed || options_.shortestCurve <= 0) return false;
    if (linksOf_[chain.points.front()].size() != 1 || linksOf_[chain.points.back()].size() != 1) return false;
    double length = 0;
    for (std::size_t i = 1; i < chain.points.size(); ++i)
      length += (at(chain.points[i]) - at(chain.points[i - 1])).norm();
    return length < options_.shortestCurve;
  }

  /// From position i forward (step 1) or backward (-1): the first point at least the reach away, or the last
  /// there is.
  Vec3 directionFrom(const Chain& chain, std::size_t i, int step) const {
    const std::size_t n = chain.points.size();
    const Vec3& origin = at(chain.points[i]);
    Vec3 away = Vec3::Zero();
    std::size_t k = i;
    for (int steps = 0; steps < kMaxReachSteps; ++steps) {
      if (!chain.closed && (step > 0 ? k + 1 == n : k == 0)) break;
      k = (k + n + step) % n;
      if (k == i) break;
      away = at(chain.points[k]) - origin;
      if (away.squaredNorm() >= reach_ * reach_) break;
    }
    return away;
  }

  double turnAt(const Chain& chain, std::size_t i) const {
    const Vec3 back = -directionFrom(chain, i, -1), ahead = directionFrom(chain, i, 1);
    return angleBetween(back.stableNormalized(), ahead.stableNormalized());
  }

  /// Positions where the chain turns by more than cornerAngle, ascending; of several within the reach the
  /// sharpest.
  std::vector<std::size_t> turningPoints(const Chain& chain) const {
    const std::size_t n = chain.points.size(), margin = chain.closed ? 0 : 1;
    std::vector<double> turn(n, 0);
    for (std::size_t i = margin; i + margin < n; ++i) turn[i] = turnAt(chain, i);
    std::vector<std::size_t> found;
    for (std::size_t i = margin; i + margin < n; ++i)
      if (turn[i] > options_.cornerAngle && isSharpest(chain, turn, i, 1) && isSharpest(chain, turn, i, -1))
        found.push_back(i);
    return found;
  }

  bool isSharpest(const Chain& chain, const std::vector<double>& turn, std::size_t i, int step) const {
    const std::size_t n = chain.points.size();
    double walked = 0;
    std::size_t k = i;
    for (int steps = 0; steps < kMaxReachSteps; ++steps) {
      if (!chain.closed && (step > 0 ? k + 1 == n : k == 0)) return true;
      const std::size_t next = (k + n + step) % n;
      walked += (at(chain.points[next]) - at(chain.points[k])).norm();
      k = next;
      if (walked >= reach_ || k == i) return true;
      if (turn[k] > turn[i] || (turn[k] == turn[i] && k < i)) return false;
    }
    return true;
  }

  Id corner(Id p) {
    if (cornerOf_[p] == kNone) {
      cornerOf_[p] = static_cast<Id>(corners_.size());
      corners_.push_back(at(p));
    }
    return cornerOf_[p];
  }

  /// Points [begin, end] of an open chain, [begin, end) of a closed one.
  void addCurve(const Chain& chain, std::size_t begin, std::size_t end) {
    FeatureCurve curve;
    curve.closed = chain.closed;
    for (std::size_t i = begin; i < end + (chain.closed ? 0 : 1); ++i)
      curve.points.push_back(at(chain.points[i]));
    if (!chain.closed) {
      curve.startCorner = corner(chain.points[begin]);
      curve.endCorner = corner(chain.points[end]);
    }
    const Id id = static_cast<Id>(curves_.size());
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t next = (i + 1) % chain.points.size();
      segments_.push_back({at(chain.points[i]), at(chain.points[next]), id, chain.kinds[i]});
    }
    curves_.push_back(std::move(curve));
  }

  const FeatureNetwork& network_;
  const FeatureOptions& options_;
  const double reach_;
  Csr<Id> linksOf_;
  std::vector<bool> visited_;
  std::vector<Id> cornerOf_;
  std::vector<Vec3> corners_;
  std::vector<FeatureCurve> curves_;
  std::vector<FeatureSegment> segments_;
};

}  // namespace

FeatureGraph traceCurves(const FeatureNetwork& network, const FeatureOptions& options, double reach) {
  return CurveBuilder(network, options, reach).run();
}

}  // namespace pm
