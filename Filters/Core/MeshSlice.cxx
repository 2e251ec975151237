// SPDX-License-Identifier: BSD-3-Clause
#include "MeshSlice.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <numeric>
#include <utility>

#include "Bvh.h"

namespace pm {

namespace {

constexpr Id kBlock = 512;  // cells a task

/// Two points of the mesh, ascending: the edge that is crossed there; twice the same: that point.
using Place = std::pair<Id, Id>;

Place placeOf(Id a, Id b) { return {std::min(a, b), std::max(a, b)}; }

/// Polygons as rows of places, before the places have numbers.
struct Loops {
  Csr<Place> places;
  std::vector<Id> cell;
};

/// Cuts cells one by one and keeps its buffers; side -1 looks at the plane from its other side, so that a
/// point in the plane counts as below.
class CellCutter {
 public:
  CellCutter(const Csr<Id>& faces, const std::vector<double>& distance, double side)
      : faces_(faces), distance_(distance), side_(side) {}

  /// Adds the polygons of a cell.
  void cut(Span<Id> cellFaces, Id cell, Loops& into) {
    links_.clear();
    between_.clear();
    for (const Id face : cellFaces) linkFace(faces_[face]);
    if (links_.empty()) return;
    joinLinks();
    for (const bool openOnly : {true, false}) {
      for (std::size_t e = 0; e < 2 * links_.size(); ++e) {
        if (links_[e / 2].used || (openOnly && mate_[e] != kNone)) continue;
        walk(e);
        if (loop_.size() < 3) continue;
        into.places.push(loop_);
        into.cell.push_back(cell);
      }
    }
  }

 private:
  /// The plane's way across a face, from the edge where the face's outline goes up to one where it goes down.
  /// Its end 0 is `up`, its end 1 `down`.
  struct Link {
    Place up, down;
    Id first = 0, last = 0;  // range of between_: points in the plane on the way
    bool used = false;
  };

  double height(Id p) const { return side_ * distance_[p]; }
  bool above(Id p) const { return height(p) >= 0; }

  Place crossing(Id a, Id b) const {
    const Id top = above(a) ? a : b;
    return height(top) == 0 ? Place(top, top) : placeOf(a, b);
  }

  void linkFace(Span<Id> face) {
    const std::size_t n = face.size();
    std::size_t start = 0;
    while (start < n && (above(face[start]) || !above(face[(start + 1) % n]))) ++start;
    if (start == n) return;
    turns_.clear();  // edges that go up and down in turn, the first goes up
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t i = (start + k) % n;
      if (above(face[i]) != above(face[(i + 1) % n])) turns_.push_back(i);
    }
    const std::size_t runs = turns_.size() / 2;
    const bool apart = runs == 1 || !centreAbove(face);  // the face's parts above the plane
    for (std::size_t r = 0; r < runs; ++r) {
      const std::size_t up = turns_[2 * r],
                        down = turns_[apart ? 2 * r + 1 : (2 * r + 2 * runs - 1) % (2 * runs)];
      Link link{placeOf(face[up], face[(up + 1) % n]), placeOf(face[down], face[(down + 1) % n])};
      link.first = static_cast<Id>(between_.size());
      if (apart) followPlane(face, (up + 1) % n, (down + 1) % n);
      link.last = static_cast<Id>(between_.size());
      links_.push_back(link);
    }
  }

  /// Adds the points of a face from one to before another to the way, when all of them lie in the plane.
  void followPlane(Span<Id> face, std::size_t from, std::size_t to) {
    const std::size_t n = face.size(), before = between_.size();
    for (std::size_t i = from; i != to; i = (i + 1) % n) {
      if (height(face[i]) > 0) return between_.resize(before);
      between_.push_back(face[i]);
    }
  }

  /// Sums in the order of the values, so that both cells of a face see the same.
  bool centreAbove(Span<Id> face) {
    heights_.clear();
    for (const Id p : face) heights_.push_back(height(p));
    std::sort(heights_.begin(), heights_.end());
    return std::accumulate(heights_.begin(), heights_.end(), 0.0) >= 0;
  }

  const Place& edgeAt(std::size_t end) const { return end % 2 ? links_[end / 2].down : links_[end / 2].up; }

  /// mate_[end]: the end of another link at the same edge.
  void joinLinks() {
    const std::size_t ends = 2 * links_.size();
    order_.resize(ends);
    std::iota(order_.begin(), order_.end(), std::size_t(0));
    std::sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
      return std::pair(edgeAt(a), a) < std::pair(edgeAt(b), b);
    });
    mate_.assign(ends, kNone);
    for (std::size_t i = 0; i + 1 < ends; ++i) {
      if (edgeAt(order_[i]) != edgeAt(order_[i + 1])) continue;
      mate_[order_[i]] = static_cast<Id>(order_[i + 1]);
      mate_[order_[i + 1]] = static_cast<Id>(order_[i]);
      ++i;
    }
  }

  /// The loop, or the open chain, of links that begins at an end.
  void walk(std::size_t start) {
    loop_.clear();
    for (std::size_t end = start;;) {
      Link& link = links_[end / 2];
      link.used = true;
      const bool back = end % 2 != 0;
      addPoint(crossingAt(end));
      for (Id i = link.first; i < link.last; ++i) {
        const Id p = between_[back ? link.first + link.last - 1 - i : i];
        addPoint({p, p});
      }
      addPoint(crossingAt(end ^ 1));
      const Id next = mate_[end ^ 1];
      if (next == kNone || links_[next / 2].used) break;
      end = static_cast<std::size_t>(next);
    }
    closeLoop();
  }

  Place crossingAt(std::size_t end) const { return crossing(edgeAt(end).first, edgeAt(end).second); }

  /// No point twice in a row, and no way to a point and straight back: neither encloses anything.
  void addPoint(const Place& p) {
    if (!loop_.empty() && loop_.back() == p) return;
    if (loop_.size() > 1 && loop_[loop_.size() - 2] == p) {
      loop_.pop_back();
    } else {
      loop_.push_back(p);
    }
  }

  /// The same across the loop's beginning.
  void closeLoop() {
    for (std::size_t n = loop_.size(); n > 2; n = loop_.size()) {
      if (loop_[0] == loop_[n - 1]) {
        loop_.pop_back();
      } else if (loop_[0] == loop_[n - 2]) {
        loop_.resize(n - 2);
      } else if (loop_[1] == loop_[n - 1]) {
        loop_.pop_back();
        loop_.erase(loop_.begin());
      } else {
        return;
      }
    }
  }

  const Csr<Id>& faces_;
  const std::vector<double>& distance_;
  const double side_;
  std::vector<Link> links_;
  std::vector<Id> between_, mate_;
  std::vector<std::size_t> turns_, order_;
  std::vector<double> heights_;
  std::vector<Place> loop_;
};

/// How a cell lies. Cut: with points below the plane and others; touching: above it, with points in it.
enum class Pose { Clear, Cut, Touching };

Pose poseOf(const Csr<Id>& faces, Span<Id> cell, const std::vector<double>& distance) {
  bool below = false, above = false, in = false;
  for (const Id f : cell) {
    for (const Id p : faces[f]) {
      below = below || distance[p] < 0;
      above = above || distance[p] > 0;
      in = in || distance[p] == 0;
    }
  }
  if (below) return above || in ? Pose::Cut : Pose::Clear;
  return in ? Pose::Touching : Pose::Clear;
}

void append(Loops& to, const Loops& from) {
  for (Id i = 0; i < from.places.rows(); ++i) to.places.push(from.places[i]);
  to.cell.insert(to.cell.end(), from.cell.begin(), from.cell.end());
}

/// Polygons of all cells of one pose; those that touch the plane are cut as seen from its other side.
Loops loopsOf(const Csr<Id>& faces, const Csr<Id>& cells, const std::vector<double>& distance, Pose pose) {
  const Id blocks = (cells.rows() + kBlock - 1) / kBlock;
  std::vector<Loops> parts(blocks);
  tbb::parallel_for(Id(0), blocks, [&](Id block) {
    CellCutter cutter(faces, distance, pose == Pose::Cut ? 1.0 : -1.0);
    for (Id c = block * kBlock; c < std::min((block + 1) * kBlock, cells.rows()); ++c) {
      if (poseOf(faces, cells[c], distance) == pose) cutter.cut(cells[c], c, parts[block]);
    }
  });
  Loops all;
  for (const Loops& part : parts) append(all, part);
  return all;
}

/// Where places are in the plane: two coordinates and 0.
class PlaneFrame {
 public:
  PlaneFrame(const SlicePlane& plane, const std::vector<double>& distance,
             const std::function<Vec3(Id)>& position)
      : origin_(plane.origin), distance_(distance), position_(position) {
    Vec3::Index axis;
    plane.normal.cwiseAbs().minCoeff(&axis);
    u_ = plane.normal.cross(Vec3::Unit(axis)).normalized();
    v_ = plane.normal.cross(u_);
  }

  Vec3 operator()(const Place& place) const {
    const auto [low, high] = place;
    const Vec3 a = position_(low) - origin_;
    const Vec3 p = low == high ? a : Vec3(a + part(place) * (position_(high) - origin_ - a));
    return {u_.dot(p), v_.dot(p), 0.0};
  }

  /// Of the way from the first point to the second.
  double part(const Place& place) const {
    const auto [low, high] = place;
    return low == high ? 0.0 : distance_[low] / (distance_[low] - distance_[high]);
  }

 private:
  const Vec3 origin_;
  const std::vector<double>& distance_;
  const std::function<Vec3(Id)>& position_;
  Vec3 u_, v_;
};

/// A point on sides that polygons share is in exactly one of them.
bool contains(Span<Vec3> polygon, const Vec3& p) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vec3 &a = polygon[i], &b = polygon[j];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    const Vec3 &low = a.y() < b.y() ? a : b, &high = a.y() < b.y() ? b : a;  // the same for both polygons
    if (p.x() < low.x() + (p.y() - low.y()) / (high.y() - low.y()) * (high.x() - low.x())) inside = !inside;
  }
  return inside;
}

/// The polygons in flat coordinates.
Csr<Vec3> flatten(const Loops& loops, const PlaneFrame& frame) {
  Csr<Vec3> flat;
  flat.offsets = loops.places.offsets;
  flat.values.resize(loops.places.values.size());
  tbb::parallel_for(std::size_t(0), flat.values.size(),
                    [&](std::size_t i) { flat.values[i] = frame(loops.places.values[i]); });
  return flat;
}

/// Those of the polygons whose centres the others do not cover.
Loops uncovered(const Loops& loops, const Loops& others, const PlaneFrame& frame) {
  const Csr<Vec3> flat = flatten(loops, frame), cover = flatten(others, frame);
  std::vector<Box> boxes(cover.rows());
  tbb::parallel_for(Id(0), cover.rows(), [&](Id i) {
    for (const Vec3& p : cover[i]) boxes[i].add(p);
  });
  const Bvh tree(boxes);
  std::vector<char> covered(flat.rows());
  tbb::parallel_for(Id(0), flat.rows(), [&](Id i) {
    Vec3 centre = Vec3::Zero();
    for (const Vec3& p : flat[i]) centre += p / static_cast<double>(flat[i].size());
    covered[i] = tree.any([&](Id, const Box& box) { return box.contains(centre); },
                          [&](Id slot) { return contains(cover[tree.order()[slot]], centre); });
  });
  Loops kept;
  for (Id i = 0; i < flat.rows(); ++i) {
    if (covered[i]) continue;
    kept.places.push(loops.places[i]);
    kept.cell.push_back(loops.cell[i]);
  }
  return kept;
}

/// Gives the places numbers.
PlaneSection number(const Loops& loops, const PlaneFrame& frame) {
  std::vector<Place> places = loops.places.values;
  tbb::parallel_sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  PlaneSection section;
  section.points.resize(places.size());
  tbb::parallel_for(std::size_t(0), places.size(), [&](std::size_t i) {
    section.points[i] = {places[i].first, places[i].second, frame.part(places[i])};
  });
  section.cell = loops.cell;
  section.polygons.offsets = loops.places.offsets;
  section.polygons.values.resize(loops.places.values.size());
  tbb::parallel_for(std::size_t(0), loops.places.values.size(), [&](std::size_t i) {
    const auto at = std::lower_bound(places.begin(), places.end(), loops.places.values[i]);
    section.polygons.values[i] = static_cast<Id>(at - places.begin());
  });
  return section;
}

/// Turns polygons that run clockwise.
void orient(PlaneSection& section, const PlaneFrame& frame) {
  std::vector<Vec3> flat(section.points.size());
  tbb::parallel_for(std::size_t(0), flat.size(), [&](std::size_t i) {
    flat[i] = frame({section.points[i].low, section.points[i].high});
  });
  tbb::parallel_for(Id(0), section.polygons.rows(), [&](Id i) {
    const Span<Id> row = section.polygons[i];
    double area = 0;
    for (std::size_t k = 1; k + 1 < row.size(); ++k) {
      area += (flat[row[k]] - flat[row[0]]).cross(flat[row[k + 1]] - flat[row[0]]).z();
    }
    Id* values = section.polygons.values.data();
    if (area < 0)
      std::reverse(values + section.polygons.offsets[i], values + section.polygons.offsets[i + 1]);
  });
}

}  // namespace

PlaneSection sliceCells(const Csr<Id>& faces, const Csr<Id>& cells, const std::vector<double>& distance,
                        const std::function<Vec3(Id)>& position, const SlicePlane& plane, Monitor& monitor) {
  monitor.check(0.0, "cutting cells");
  Loops loops = loopsOf(faces, cells, distance, Pose::Cut);
  monitor.check(0.5, "cells that touch the plane");
  const PlaneFrame frame(plane, distance, position);
  const Loops touching = loopsOf(faces, cells, distance, Pose::Touching);
  if (!touching.cell.empty()) append(loops, uncovered(touching, loops, frame));
  monitor.check(0.8, "numbering points");
  PlaneSection section = number(loops, frame);
  orient(section, frame);
  return section;
}

}  // namespace pm
