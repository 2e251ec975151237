// SPDX-License-Identifier: BSD-3-Clause
#include "NarrowPassages.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "Bvh.h"
#include "TriangleBox.h"

namespace pm {
namespace {

constexpr double kSeam = 0.05;      // of a leaf's edge; less is no gap but two parts that touch
constexpr double kFacing = 0.707;   // cosine of 45 degrees
constexpr std::size_t kPieces = 6;  // pieces of surface looked at in one leaf, an even sample
constexpr int kGapsInLeaf = 4;
constexpr Id kLeastCells = 3;  // smaller places are corners and contacts, not passages

struct Hit {
  double at = 2;  // part of the segment, above 1 = none
  Id triangle = kNone;
};

/// Segments against the triangles.
class LineOfSight {
 public:
  explicit LineOfSight(const SurfaceModel& model) : model_(model), bvh_(model.hierarchy()) {}

  /// First triangle on the segment p-q beyond `from` (a part of it); its rim counts. Ties go to the smaller
  /// id.
  Hit firstHit(const Vec3& p, const Vec3& q, double from) const {
    Hit hit;
    search(p, q, from, hit, false);
    return hit;
  }
  bool clear(const Vec3& p, const Vec3& q) const {
    Hit hit;
    return !search(p, q, 0, hit, true);
  }

 private:
  /// Keeps the first hit, or ends with any.
  bool search(const Vec3& p, const Vec3& q, double from, Hit& hit, bool anyWillDo) const {
    constexpr double kLevel = 1e-200;  // stands for no component along an axis
    constexpr double kRounding = 1e-9;
    const Vec3 d = q - p;
    const Eigen::Array3d parts = (d.array().abs() > kLevel).select(d.array(), kLevel).inverse();
    const auto enter = [&](Id, const Box& box) {
      const Eigen::Array3d toLo = (box.lo - p).array() * parts, toHi = (box.hi - p).array() * parts;
      const double in = toLo.min(toHi).maxCoeff() - kRounding, out = toLo.max(toHi).minCoeff() + kRounding;
      return in <= out && out >= from && in <= std::min(hit.at, 1.0);
    };
    return bvh_.any(enter, [&](Id slot) {
      test(bvh_.order()[slot], p, d, from, hit);
      return anyWillDo && hit.triangle != kNone;
    });
  }

  void test(Id t, const Vec3& p, const Vec3& d, double from, Hit& hit) const {
    const Vec3& a = model_.corner(t, 0);
    const Vec3& normal = model_.normal(t);
    const double slope = d.dot(normal);
    if (std::abs(slope) <= 1e-12 * d.norm()) return;  // seen edge-on
    const double at = (a - p).dot(normal) / slope;
    if (at < from || at > 1 || at > hit.at || (at == hit.at && t > hit.triangle)) return;
    const Vec3 ab = model_.corner(t, 1) - a, ac = model_.corner(t, 2) - a, n = ab.cross(ac),
               e = p + at * d - a;
    const double area = n.squaredNorm(), v = e.cross(ac).dot(n) / area, w = ab.cross(e).dot(n) / area;
    constexpr double kRim = -1e-9;
    if (v >= kRim && w >= kRim && v + w <= 1 - kRim) hit = {at, t};
  }

  const SurfaceModel& model_;
  const Bvh& bvh_;
};

/// Calls body(leaf, direction) for leaves up to `rings` (1 or 2) times the leaf's own size away.
template <class Body>
void forLeavesAround(const Octree& tree, Id leaf, const Body& body, int rings = 1) {
  const Coord c = tree.corner(leaf);
  const std::int32_t span = tree.brick.span(tree.levels[leaf]);
  Key part[3][5];  // of a key along each axis
  bool inside[3][5];
  for (int a = 0; a < 3; ++a)
    for (int i = -rings; i <= rings; ++i) {
      Coord q{0, 0, 0};
      q[a] = c[a] + i * span + (i < 0 ? span - 1 : 0);
      inside[a][i + 2] = q[a] >= 0 && q[a] < tree.brick.extent(a);
      part[a][i + 2] = inside[a][i + 2] ? encode(q) : 0;
    }
  for (int z = -rings; z <= rings; ++z)
    for (int y = -rings; y <= rings; ++y)
      for (int x = -rings; x <= rings; ++x) {
        if (!inside[0][x + 2] || !inside[1][y + 2] || !inside[2][z + 2] || (x == 0 && y == 0 && z == 0))
          continue;
        const Id other = tree.covering(part[0][x + 2] | part[1][y + 2] | part[2][z + 2]);
        if (other != kNone) body(other, Vec3(x, y, z));
      }
}

struct Gap {
  Vec3 middle, across;
  double width;
  Id leaf;  // that holds the middle
  Id triangle[2];
  int wave = kNone;      // in which it was found free
  bool visible = false;  // from a painted leaf
  Id next = kNone;       // gap in the same leaf
};

class NarrowSearch {
 public:
  NarrowSearch(const Octree& tree, const SurfaceModel& model, const std::vector<std::uint8_t>& painted,
               const Regions& regions)
      : tree_(tree),
        model_(model),
        sight_(model),
        painted_(painted),
        regions_(regions),
        first_(tree.size(), kNone),
        asked_(tree.size(), 0) {}

  NarrowPassages run(Monitor& monitor) {
    std::vector<Id> frontier = look(measure(cutLeaves(), true), 0, 0);
    for (int wave = 1; !frontier.empty(); ++wave) {
      monitor.check(0.84, "narrow passages");
      const Id fresh = static_cast<Id>(gaps_.size());
      const std::vector<Id> candidates =
          unreachedAround(frontier, measure(unmeasuredAround(frontier), false));
      frontier = look(candidates, fresh, wave);
    }
    return collect();
  }

 private:
  bool isOpen(Id leaf) const { return painted_[leaf] && !tree_.cut[leaf]; }

  /// A piece of surface in a leaf, and where its plane passes the leaf's centre.
  struct Piece {
    Id triangle;
    Vec3 normal;
    double offset;
  };
  struct Pieces {
    std::array<Piece, kPieces> all;
    int count = 0;
  };
  /// Directions to the leaves around that are not cut.
  struct FreeSides {
    std::array<Vec3, 26> way;
    int count = 0;
    bool besidePainted = false;
    // In a cone of 45 degrees, so that along an axis only the leaf straight across counts.
    bool hold(const Vec3& direction) const {
      constexpr double kStraight = 0.71;
      return std::any_of(way.begin(), way.begin() + count,
                         [&](const Vec3& w) { return w.dot(direction) > kStraight; });
    }
  };

  /// Leaves that do fit somewhere in a narrow space, but not one beside the other.
  bool isPocket(Id leaf) const {
    constexpr Id kPocket = 1000;
    return !painted_[leaf] && regions_.list[regions_.ofLeaf[leaf]].cells < kPocket;
  }

  FreeSides freeSides(Id leaf) const {
    FreeSides sides;
    forLeavesAround(tree_, leaf, [&](Id other, const Vec3& d) {
      sides.besidePainted = sides.besidePainted || painted_[other];
      if (!tree_.cut[other] && !isPocket(other)) sides.way[sides.count++] = d.normalized();
    });
    return sides;
  }

  /// Different pieces among an even sample of the leaf's triangles.
  Pieces piecesIn(Id leaf) const {
    Pieces pieces;
    const Vec3 centre = tree_.box(leaf).centre();
    const double apart = kSeam * tree_.brick.edge(tree_.levels[leaf]);
    const Span<Id> list = tree_.triangles[leaf];
    const std::size_t sample = std::min(list.size(), kPieces);
    for (std::size_t i = 0; i < sample; ++i) {
      const Id t = list[i * list.size() / sample];
      const Vec3& n = model_.normal(t);
      const double offset = n.dot(model_.corner(t, 0) - centre);
      const bool known =
          std::any_of(pieces.all.begin(), pieces.all.begin() + pieces.count, [&](const Piece& p) {
            const double turn = p.normal.dot(n);
            return std::abs(turn) > 0.95 && std::abs(offset - (turn > 0 ? p.offset : -p.offset)) < apart;
          });
      if (!known) pieces.all[pieces.count++] = {t, n, offset};
    }
    return pieces;
  }

  /// Does another piece lie ahead of this one, more or less parallel, in the same leaf?
  bool pieceAhead(const Pieces& pieces, const Piece& piece, double sign, double apart) const {
    return std::any_of(pieces.all.begin(), pieces.all.begin() + pieces.count, [&](const Piece& p) {
      const double turn = p.normal.dot(piece.normal);
      const double offset = (turn > 0 ? p.offset : -p.offset) - piece.offset;
      return std::abs(turn) > kFacing && sign * offset > apart;
    });
  }

  // Straight across from a piece there is no gap where a leaf is free, unless another piece runs before that
  // leaf.
  void gapsFrom(Id leaf, bool onlyBesidePainted, std::vector<Gap>& gaps) const {
    const FreeSides sides = freeSides(leaf);
    if (onlyBesidePainted && !sides.besidePainted) return;
    const double edge = tree_.brick.edge(tree_.levels[leaf]);
    const Pieces pieces = piecesIn(leaf);
    for (int i = 0; i < pieces.count; ++i)
      for (double sign : {1.0, -1.0}) {
        const Piece& piece = pieces.all[i];
        const Vec3 way = sign * piece.normal;
        if (!sides.hold(way) || pieceAhead(pieces, piece, sign, kSeam * edge))
          addGap(leaf, piece.triangle, way, gaps);
      }
  }

  void addGap(Id leaf, Id t, const Vec3& way, std::vector<Gap>& gaps) const {
    const double edge = tree_.brick.edge(tree_.levels[leaf]), reach = edge / featureSizeShowing(1, way);
    const Vec3 from =
        cutCentre(tree_.box(leaf), model_.corner(t, 0), model_.corner(t, 1), model_.corner(t, 2));
    const Hit hit = sight_.firstHit(from, from + reach * way, kSeam * edge / reach);
    if (hit.triangle == kNone || std::abs(model_.normal(hit.triangle).dot(way)) < kFacing) return;
    Gap gap;
    gap.width = hit.at * reach;
    gap.middle = from + 0.5 * gap.width * way;
    gap.across = way;
    gap.leaf = tree_.locate(gap.middle);
    if (gap.leaf == kNone) return;  // the geometry goes on beyond the domain, and the gap with it
    gap.triangle[0] = t;
    gap.triangle[1] = hit.triangle;
    gaps.push_back(gap);
  }

  /// Measures the gaps from the surface in these leaves; returns the new gaps.
  std::vector<Id> measure(const std::vector<Id>& leaves, bool onlyBesidePainted) {
    constexpr std::size_t kBlock = 256;
    std::vector<std::vector<Gap>> found((leaves.size() + kBlock - 1) / kBlock);
    tbb::parallel_for(std::size_t(0), found.size(), [&](std::size_t block) {
      const std::size_t end = std::min(leaves.size(), (block + 1) * kBlock);
      for (std::size_t i = block * kBlock; i < end; ++i) gapsFrom(leaves[i], onlyBesidePainted, found[block]);
    });
    const Id firstNew = static_cast<Id>(gaps_.size());
    for (const std::vector<Gap>& block : found)
      for (const Gap& gap : block) keep(gap);
    std::vector<Id> fresh(gaps_.size() - firstNew);
    std::iota(fresh.begin(), fresh.end(), firstNew);
    return fresh;
  }

  // The same gap is found from both its sides and from many triangles.
  void keep(Gap gap) {
    const double near = 0.2 * tree_.brick.edge(tree_.levels[gap.leaf]);
    int count = 0;
    for (Id g = first_[gap.leaf]; g != kNone; g = gaps_[g].next)
      if (++count == kGapsInLeaf || (gaps_[g].middle - gap.middle).squaredNorm() < near * near) return;
    gap.next = first_[gap.leaf];
    first_[gap.leaf] = static_cast<Id>(gaps_.size());
    gaps_.push_back(gap);
  }

  std::vector<Id> cutLeaves() const {
    std::vector<Id> leaves;
    for (Id leaf = 0; leaf < tree_.size(); ++leaf)
      if (tree_.cut[leaf]) leaves.push_back(leaf);
    return leaves;
  }

  std::vector<Id> unmeasuredAround(const std::vector<Id>& frontier) {
    std::vector<Id> leaves;
    const auto ask = [&](Id leaf) {
      if (asked_[leaf] || !tree_.cut[leaf]) return;
      asked_[leaf] = 1;
      leaves.push_back(leaf);
    };
    for (Id g : frontier) {
      ask(gaps_[g].leaf);
      forLeavesAround(tree_, gaps_[g].leaf, [&](Id other, const Vec3&) { ask(other); });
    }
    return leaves;
  }

  template <class Body>
  void forGapsAround(Id leaf, const Body& body) const {
    const auto all = [&](Id in) {
      for (Id g = first_[in]; g != kNone; g = gaps_[g].next) body(g);
    };
    all(leaf);
    forLeavesAround(tree_, leaf, [&](Id other, const Vec3&) { all(other); });
  }

  std::vector<Id> unreachedAround(const std::vector<Id>& frontier, std::vector<Id> candidates) const {
    for (Id g : frontier)
      forGapsAround(gaps_[g].leaf, [&](Id other) {
        if (gaps_[other].wave == kNone) candidates.push_back(other);
      });
    sortUnique(candidates);
    return candidates;
  }

  /// The point of the leaf that is likely to see the gap: near its middle and between its sides.
  Vec3 viewpoint(Id leaf, const Gap& gap) const {
    const Box box = tree_.box(leaf);
    const Vec3 inset = 0.01 * box.size(), lo = box.lo + inset, hi = box.hi - inset;
    Vec3 p = gap.middle.cwiseMax(lo).cwiseMin(hi);
    for (int round = 0; round < 3; ++round)
      p = (p - gap.across.dot(p - gap.middle) * gap.across).cwiseMax(lo).cwiseMin(hi);
    return p;
  }

  // From beside the planes of a gap's walls there is no way in.
  bool seenFrom(Id leaf, const Gap& gap) const {
    const Vec3 from = viewpoint(leaf, gap);
    return std::abs(gap.across.dot(from - gap.middle)) < 0.5 * gap.width && sight_.clear(from, gap.middle);
  }

  // Two leaves away, for a mouth that lies on cell faces is cut on both sides.
  bool seenFromPainted(const Gap& gap) const {
    bool seen = isOpen(gap.leaf);
    const auto ask = [&](Id other, const Vec3&) { seen = seen || (isOpen(other) && seenFrom(other, gap)); };
    forLeavesAround(tree_, gap.leaf, ask, 2);
    return seen;
  }

  // Middles far out of the other's walls lie on the other side of a wall.
  static bool alongside(const Gap& a, const Gap& b) {
    const Vec3 d = b.middle - a.middle;
    const double reach = 0.45 * (a.width + b.width);
    return std::abs(d.dot(a.across)) < reach || std::abs(d.dot(b.across)) < reach;
  }

  /// From a gap that was found free in this wave or later.
  bool seenFromGaps(const Gap& gap, int since) const {
    bool seen = false;
    forGapsAround(gap.leaf, [&](Id other) {
      const Gap& from = gaps_[other];
      if (!seen && from.wave != kNone && from.wave >= since && alongside(from, gap))
        seen = sight_.clear(from.middle, gap.middle);
    });
    return seen;
  }

  /// Which of the candidates are free; those seen in this wave. Only gaps from `fresh` on have not been
  /// looked at from everything that was free before.
  std::vector<Id> look(const std::vector<Id>& candidates, Id fresh, int wave) {
    std::vector<std::uint8_t> found(candidates.size(), 0);  // 2 = from a painted leaf
    tbb::parallel_for(std::size_t(0), candidates.size(), [&](std::size_t i) {
      const Gap& gap = gaps_[candidates[i]];
      const bool isFresh = candidates[i] >= fresh;
      if (isFresh && seenFromPainted(gap))
        found[i] = 2;
      else if (wave > 0 && seenFromGaps(gap, isFresh ? 0 : wave - 1))
        found[i] = 1;
    });
    std::vector<Id> seen;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (found[i] == 0) continue;
      gaps_[candidates[i]].wave = wave;
      gaps_[candidates[i]].visible = found[i] == 2;
      seen.push_back(candidates[i]);
    }
    return seen;
  }

  // A leaf is hidden when none of its free gaps is seen from a painted leaf; its narrowest gap stands for it.
  std::vector<Id> hiddenGaps() const {
    std::vector<Id> hidden;
    for (Id leaf = 0; leaf < tree_.size(); ++leaf) {
      if (first_[leaf] == kNone || painted_[leaf]) continue;
      Id best = kNone;
      bool visible = false;
      for (Id g = first_[leaf]; g != kNone; g = gaps_[g].next) {
        if (gaps_[g].wave == kNone) continue;
        visible = visible || gaps_[g].visible;
        if (best == kNone || gaps_[g].width <= gaps_[best].width) best = g;
      }
      if (best != kNone && !visible) hidden.push_back(best);
    }
    return hidden;
  }

  /// Sets of hidden gaps in adjacent leaves, in rows; largest first, then by the smaller leaf.
  std::vector<std::vector<Id>> places() {
    const std::vector<Id> hidden = hiddenGaps();
    std::vector<Id> gapOf(tree_.size(), kNone);
    for (Id g : hidden) gapOf[gaps_[g].leaf] = g;
    std::vector<std::vector<Id>> rows;
    for (Id start : hidden) {
      if (gapOf[gaps_[start].leaf] == kNone) continue;
      std::vector<Id> row{start};
      gapOf[gaps_[start].leaf] = kNone;
      for (std::size_t i = 0; i < row.size(); ++i)
        forLeavesAround(tree_, gaps_[row[i]].leaf, [&](Id other, const Vec3&) {
          if (gapOf[other] == kNone) return;
          row.push_back(gapOf[other]);
          gapOf[other] = kNone;
        });
      if (static_cast<Id>(row.size()) >= kLeastCells) rows.push_back(std::move(row));
    }
    std::stable_sort(rows.begin(), rows.end(),
                     [](const auto& a, const auto& b) { return a.size() > b.size(); });
    return rows;
  }

  Id regionSeenFrom(const Gap& gap) const {
    Id best = kNone;
    forLeavesAround(tree_, gap.leaf, [&](Id other, const Vec3&) {
      const Id id = tree_.cut[other] ? kNone : regions_.ofLeaf[other];
      if (id == kNone || regions_.list[id].chosen || (best != kNone && id >= best)) return;
      if (seenFrom(other, gap)) best = id;
    });
    return best;
  }

  NarrowPlace describe(const std::vector<Id>& row) const {
    NarrowPlace place;
    place.cells = static_cast<Id>(row.size());
    std::vector<double> widths, sizes;
    for (Id g : row) {
      const Gap& gap = gaps_[g];
      place.centre += gap.middle / double(row.size());
      place.bounds.add(gap.middle);
      widths.push_back(gap.width);
      sizes.push_back(featureSizeShowing(gap.width, gap.across));
      for (Id t : gap.triangle) place.patches.push_back(model_.patchOf(t));
      const Id region = regionSeenFrom(gap);
      if (region != kNone && (place.leadsTo == kNone || region < place.leadsTo)) place.leadsTo = region;
    }
    std::sort(place.patches.begin(), place.patches.end());
    place.patches.erase(std::unique(place.patches.begin(), place.patches.end()), place.patches.end());
    std::sort(widths.begin(), widths.end());
    std::sort(sizes.begin(), sizes.end());
    place.narrowest = widths.front();
    place.median = widths[widths.size() / 2];
    place.featureSize = sizes[sizes.size() / 2];
    return place;
  }

  NarrowPassages collect() {
    NarrowPassages out;
    for (const std::vector<Id>& row : places()) {
      for (Id g : row)
        out.cells.push_back({gaps_[g].middle, gaps_[g].width,
                             featureSizeShowing(gaps_[g].width, gaps_[g].across),
                             static_cast<Id>(out.places.size())});
      out.places.push_back(describe(row));
    }
    return out;
  }

  const Octree& tree_;
  const SurfaceModel& model_;
  const LineOfSight sight_;
  const std::vector<std::uint8_t>& painted_;
  const Regions& regions_;
  std::vector<Gap> gaps_;
  std::vector<Id> first_;  // newest gap in each leaf
  std::vector<std::uint8_t> asked_;
};

}  // namespace

double featureSizeShowing(double width, const Vec3& across) {
  // Three sorted parts: sum + largest + middle = 2 (sum) - smallest.
  const Vec3 n = across.cwiseAbs();
  return width / (2 * n.sum() - n.minCoeff());
}

NarrowPassages findNarrowPassages(const Octree& tree, const SurfaceModel& model,
                                  const std::vector<std::uint8_t>& painted, const Regions& regions,
                                  Monitor& monitor) {
  monitor.check(0.95, "narrow passages");
  return NarrowSearch(tree, model, painted, regions).run(monitor);
}

}  // namespace pm
