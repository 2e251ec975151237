// SPDX-License-Identifier: BSD-3-Clause
#include "SurfaceModel.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "Bvh.h"
#include "ClosestPoint.h"

namespace pm {

namespace {

using Triangle = SurfaceModel::Triangle;

// Squares of squares of lengths must stay finite.
constexpr double kLargestCoordinate = 1e70;
// Sine below which a triangle counts as a needle and its edges are measured too; above it one projection
// decides.
constexpr double kNeedleSine2 = 1e-12;

std::uint64_t mix(std::uint64_t h) {
  h ^= h >> 30;
  h *= 0xbf58476d1ce4e5b9ull;
  h ^= h >> 27;
  h *= 0x94d049bb133111ebull;
  return h ^ (h >> 31);
}

std::uint64_t combine(std::uint64_t h, std::uint64_t v) { return mix(h * 0x9e3779b97f4a7c15ull + v); }

std::uint64_t bits(double v) {
  std::uint64_t out;
  std::memcpy(&out, &v, sizeof out);
  return out;
}

std::uint64_t hashOf(const Vec3& p) {
  return combine(combine(combine(1, bits(p[0])), bits(p[1])), bits(p[2]));
}
std::uint64_t hashOf(const Triangle& t) {
  return combine(combine(combine(2, std::uint64_t(t[0])), std::uint64_t(t[1])), std::uint64_t(t[2]));
}

/// Open-addressing set of row numbers of an array: finds the row that equals a new one.
template <class Value>
class RowSet {
 public:
  explicit RowSet(std::size_t capacity) {
    std::size_t size = 16;
    while (size < 2 * capacity) size *= 2;
    rows_.assign(size, kNone);
  }
  /// The row of `values` equal to `value`, or `row` after remembering it.
  Id insert(const std::vector<Value>& values, const Value& value, Id row) {
    std::size_t at = hashOf(value) & (rows_.size() - 1);
    while (rows_[at] != kNone && values[rows_[at]] != value) at = (at + 1) & (rows_.size() - 1);
    if (rows_[at] == kNone) rows_[at] = row;
    return rows_[at];
  }

 private:
  std::vector<Id> rows_;
};

Triangle sorted(Triangle t) {
  std::sort(t.begin(), t.end());
  return t;
}

/// Unit normal; zero when the three corners are on a line as far as double precision can tell.
Vec3 unitNormal(const Vec3& a, const Vec3& b, const Vec3& c) {
  std::array<Vec3, 3> edge{b - a, c - b, a - c};
  const double scale =
      std::max({edge[0].cwiseAbs().maxCoeff(), edge[1].cwiseAbs().maxCoeff(), edge[2].cwiseAbs().maxCoeff()});
  if (!(scale > 0)) return Vec3::Zero();
  for (Vec3& e : edge) e /= scale;
  // Of the three equal cross products the one of the two shorter edges is the most accurate.
  int longest = 0;
  for (int k = 1; k < 3; ++k)
    if (edge[k].squaredNorm() > edge[longest].squaredNorm()) longest = k;
  const Vec3& e0 = edge[(longest + 1) % 3];
  const Vec3& e1 = edge[(longest + 2) % 3];
  const Vec3 n = e0.cross(e1);
  const double noise = 8 * std::numeric_limits<double>::epsilon() * e0.norm() * e1.norm();
  const double length = n.stableNorm();
  return length > noise ? Vec3(n / length) : Vec3::Zero();
}

/// Point of the triangle closest to p; a, b, c in ascending order of their point ids, so that triangles that
/// share an edge compute the same distance to it. Works relative to corners: far from the origin nothing is
/// lost.
Closest closestOnCorners(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, Id id) {
  Closest best;
  best.triangle = id;
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const Vec3 n = ab.cross(ac);
  const double n2 = n.squaredNorm();
  const double v = ap.cross(ac).dot(n), w = ab.cross(ap).dot(n), u = n2 - v - w;
  const bool needle = !(n2 > kNeedleSine2 * ab.squaredNorm() * ac.squaredNorm());
  if (n2 > 0 && u >= 0 && v >= 0 && w >= 0) {
    const Vec3 r = (v / n2) * ab + (w / n2) * ac;
    keepCloser(best, a + r, (ap - r).squaredNorm());
    if (!needle) return best;
  }
  // The closest point lies on an edge that p sees.
  if (needle || w < 0) closestOnEdge(p, a, b, best);
  if (needle || v < 0) closestOnEdge(p, a, c, best);
  if (needle || u < 0) closestOnEdge(p, b, c, best);
  return best;
}

void checkInput(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                const std::vector<Id>& patchOfTriangle, const std::vector<std::string>& patchNames) {
  constexpr std::size_t most = std::numeric_limits<Id>::max() / 4;
  if (triangles.empty()) throw InputError("The geometry has no triangles; give a surface made of triangles.");
  if (points.size() > most || triangles.size() > most)
    throw InputError(fmt::format("The geometry has more than {} points or triangles; decimate it.", most));
  if (patchOfTriangle.size() != triangles.size())
    throw InputError(
        fmt::format("The geometry has {} triangles but {} patch numbers; give one for each triangle.",
                    triangles.size(), patchOfTriangle.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!(points[i].cwiseAbs().maxCoeff() <= kLargestCoordinate) || !points[i].allFinite())
      throw InputError(
          fmt::format("Point {} of the geometry is ({}, {}, {}), which is not a usable position; repair "
                      "or remove it.",
                      i, points[i][0], points[i][1], points[i][2]));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (Id p : triangles[t])
      if (p < 0 || static_cast<std::size_t>(p) >= points.size())
        throw InputError(
            fmt::format("Triangle {} of the geometry uses point {}, but there are {} points; the file is "
                        "damaged.",
                        t, p, points.size()));
    if (patchOfTriangle[t] < 0 || static_cast<std::size_t>(patchOfTriangle[t]) >= patchNames.size())
      throw InputError(
          fmt::format("Triangle {} of the geometry belongs to patch {}, but {} patches are named; name "
                      "every patch.",
                      t, patchOfTriangle[t], patchNames.size()));
  }
}

/// For each point the first one at the same place. A negative zero counts as zero.
std::vector<Id> mergePoints(std::vector<Vec3>& points) {
  RowSet<Vec3> set(points.size());
  std::vector<Id> first(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].array() += 0.0;
    first[i] = set.insert(points, points[i], static_cast<Id>(i));
  }
  return first;
}

}  // namespace

struct SurfaceModel::Hierarchy {
  struct Slot {
    Triangle corners;  // ascending
    Id id;
  };
  Bvh bvh;
  std::vector<Slot> slots;

  /// Calls enough(part of the way) where the segment meets a triangle, until it says true.
  template <class Enough>
  bool anyHit(const std::vector<Vec3>& points, const Vec3& p, const Vec3& q, const Enough& enough) const {
    Box path;
    path.add(p);
    path.add(q);
    return bvh.anyOverlapping(path, [&](Id slot) {
      const Triangle& t = slots[slot].corners;
      const double at = rayHit(p, q - p, points[t[0]], points[t[1]], points[t[2]]);
      return at >= 0 && at <= 1 && enough(at);
    });
  }

  explicit Hierarchy(const SurfaceModel& model) {
    std::vector<Box> boxes(model.triangles_.size());
    const auto each = [&](const auto& body) { tbb::parallel_for(Id(0), model.triangleCount(), body); };
    each([&](Id t) {
      for (int k = 0; k < 3; ++k) boxes[t].add(model.corner(t, k));
    });
    bvh = Bvh(boxes);
    slots.resize(boxes.size());
    each([&](Id slot) {
      const Id t = bvh.order()[slot];
      slots[slot] = {sorted(model.triangles_[t]), t};
    });
  }
};

SurfaceModel::SurfaceModel(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                           const std::vector<Id>& patchOfTriangle, std::vector<std::string> patchNames)
    : patchNames_(std::move(patchNames)) {
  checkInput(points, triangles, patchOfTriangle, patchNames_);
  std::vector<Vec3> places = points;
  const std::vector<Id> merged = mergePoints(places);

  std::vector<Id> newId(points.size(), kNone);
  std::vector<Triangle> kept;
  kept.reserve(triangles.size());
  RowSet<Triangle> seen(triangles.size());
  triangles_.reserve(triangles.size());
  normals_.reserve(triangles.size());
  patch_.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Triangle t{merged[triangles[i][0]], merged[triangles[i][1]], merged[triangles[i][2]]};
    const Vec3 n = unitNormal(places[t[0]], places[t[1]], places[t[2]]);
    if (n.isZero(0)) continue;
    const Id row = static_cast<Id>(kept.size());
    const Triangle key = sorted(t);
    if (seen.insert(kept, key, row) != row) continue;
    kept.push_back(key);
    Triangle ids;
    for (int k = 0; k < 3; ++k) {
      if (newId[t[k]] == kNone) {
        newId[t[k]] = static_cast<Id>(points_.size());
        points_.push_back(places[t[k]]);
        bounds_.add(places[t[k]]);
      }
      ids[k] = newId[t[k]];
    }
    triangles_.push_back(ids);
    normals_.push_back(n);
    patch_.push_back(patchOfTriangle[i]);
  }
  if (triangles_.empty())
    throw InputError(
        "None of the geometry's triangles has an area; check its coordinates and their precision.");

  for (const Vec3& p : points_) hash_ = combine(hash_, hashOf(p));
  for (std::size_t t = 0; t < triangles_.size(); ++t)
    hash_ = combine(combine(hash_, hashOf(triangles_[t])), std::uint64_t(patch_[t]));
  for (const std::string& name : patchNames_) {
    for (const unsigned char letter : name) hash_ = combine(hash_, letter);
    hash_ = combine(hash_, name.size());
  }
  points_.shrink_to_fit();
  triangles_.shrink_to_fit();
  normals_.shrink_to_fit();
  patch_.shrink_to_fit();
  tree_ = std::make_unique<Hierarchy>(*this);
}

SurfaceModel::~SurfaceModel() = default;

const Bvh& SurfaceModel::hierarchy() const { return tree_->bvh; }

Closest SurfaceModel::closestOnTriangle(const Vec3& p, Id triangle) const {
  const Triangle t = sorted(triangles_[triangle]);
  return closestOnCorners(p, points_[t[0]], points_[t[1]], points_[t[2]], triangle);
}

Closest SurfaceModel::closest(const Vec3& p, const Closest& seed, double enough) const {
  Closest best;
  if (seed.triangle != kNone) best = closestOnTriangle(p, seed.triangle);
  constexpr double stop = -std::numeric_limits<double>::infinity();
  search(p, best, [&] { return std::sqrt(best.distance2) < enough ? stop : best.distance2; });
  return best;
}

Closest SurfaceModel::closestWithin(const Vec3& p, double reach) const {
  Closest best;
  search(p, best, [&] { return std::min(reach * reach, best.distance2); });
  return best.distance2 <= reach * reach ? best : Closest();  // what lies beyond need not be the closest
}

/// Betters `best` by what is no farther than the bound, a squared length.
template <class Bound>
void SurfaceModel::search(const Vec3& p, Closest& best, const Bound& bound2) const {
  tree_->bvh.nearest(p, bound2, [&](Id slot) {
    const auto& [t, id] = tree_->slots[slot];
    const Closest found = closestOnCorners(p, points_[t[0]], points_[t[1]], points_[t[2]], id);
    if (found.distance2 < best.distance2 ||
        (found.distance2 == best.distance2 && found.triangle < best.triangle))
      best = found;
  });
}

std::vector<Id> SurfaceModel::trianglesNear(const Box& box) const {
  std::vector<Id> found;
  tree_->bvh.overlapping(box, [&](Id slot) {
    const auto& [t, id] = tree_->slots[slot];
    Box own;
    for (Id corner : t) own.add(points_[corner]);
    if (own.overlaps(box)) found.push_back(id);
  });
  std::sort(found.begin(), found.end());
  return found;
}

// After Moeller and Trumbore, 1997.
double rayHit(const Vec3& from, const Vec3& along, const Vec3& a, const Vec3& b, const Vec3& c) {
  constexpr double miss = std::numeric_limits<double>::infinity();
  const Vec3 ab = b - a, ac = c - a, p = along.cross(ac);
  const double det = ab.dot(p);
  if (det == 0) return miss;
  const Vec3 to = from - a, q = to.cross(ab);
  const double u = to.dot(p) / det, v = along.dot(q) / det;
  constexpr double kSlack = 1e-9;  // neighbouring triangles leave no slit between them
  if (u < -kSlack || v < -kSlack || u + v > 1 + kSlack) return miss;
  return ac.dot(q) / det;
}

bool SurfaceModel::crosses(const Vec3& p, const Vec3& q) const {
  return tree_->anyHit(points_, p, q, [](double) { return true; });
}

double SurfaceModel::firstCrossing(const Vec3& p, const Vec3& q) const {
  double first = std::numeric_limits<double>::infinity();
  tree_->anyHit(points_, p, q, [&](double at) {
    first = std::min(first, at);
    return false;
  });
  return first;
}

}  // namespace pm
