// SPDX-License-Identifier: BSD-3-Clause
#include "OffsetCaps.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "DistanceField.h"
#include "DummyLayer.h"
#include "PaintFront.h"
#include "Project.h"

namespace pm {
namespace {

/// What a coarse mesh that is tried says of itself is nothing that the user should do something about.
class Trials : public PartMonitor {
 public:
  explicit Trials(Monitor& whole) : PartMonitor(whole, 0, 1) {}
  void warning(const std::string&) override {}
};

/// The octree of a feature size, with nothing that asks for other cells.
Octree coarseOctree(const SurfaceModel& model, OctreeDecomposeOptions octree, double size, Monitor& monitor) {
  octree.featureSize = size;
  octree.maxLevel = -1;
  octree.baseSize = 0;
  octree.useDomain = false;
  octree.surfaceSize = size;
  octree.patchSizes.clear();
  octree.boxes.clear();
  return decompose(model, octree, monitor);
}

/// The coarse mesh of the rooms, its wall on the geometry.
PolyMesh coarseMesh(const SurfaceModel& model, const OctreeDecomposeOptions& options, double size,
                    const InsideTest& inside, Monitor& monitor) {
  const Octree tree = coarseOctree(model, options, size, monitor);
  PaintFrontOptions front;
  front.region = Region::Points;
  for (Id leaf = 0; leaf < tree.size(); ++leaf) {
    const Vec3 centre = tree.box(leaf).centre();
    if (!tree.cut[leaf] && inside(centre)) front.points.push_back(centre);
  }
  if (front.points.empty()) throw RegionError("no cell fits inside");
  PolyMesh mesh = dummyLayer(paintFront(tree, model, front, monitor), {}, monitor);
  DistanceField field(model, mesh.finestSize);
  project(mesh, field, {}, monitor);
  return mesh;
}

/// Points and triangles, and the membranes of the holes after them.
std::unique_ptr<SurfaceModel> withMembranes(std::vector<Vec3> points,
                                            std::vector<SurfaceModel::Triangle> triangles,
                                            const std::vector<const Leak*>& holes) {
  for (const Leak* hole : holes) {
    const Id first = static_cast<Id>(points.size());
    points.insert(points.end(), hole->membrane.points.begin(), hole->membrane.points.end());
    for (const auto& t : hole->membrane.triangles)
      triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return std::make_unique<SurfaceModel>(points, triangles, std::vector<Id>(triangles.size(), 0),
                                        std::vector<std::string>{"surface"});
}

/// The triangles that reach into the box.
std::unique_ptr<SurfaceModel> within(const Box& box, const SurfaceModel& model) {
  std::vector<SurfaceModel::Triangle> triangles;
  for (const SurfaceModel::Triangle& t : model.triangles()) {
    Box own;
    for (Id p : t) own.add(model.points()[p]);
    if (own.overlaps(box)) triangles.push_back(t);
  }
  return std::make_unique<SurfaceModel>(model.points(), triangles, std::vector<Id>(triangles.size(), 0),
                                        std::vector<std::string>{"surface"});
}

/// The wall as triangles about the centres of its faces, normals leaving the mesh.
Caps wallOf(const PolyMesh& mesh) {
  Caps caps;
  caps.points = mesh.points;
  for (Id b = 0; b < mesh.boundaryFaces(); ++b) {
    if (!mesh.isWallPatch(mesh.patch[b])) continue;
    const Span<Id> face = mesh.faces[mesh.internalFaces() + b];
    Vec3 centre = Vec3::Zero();
    for (Id p : face) centre += mesh.points[p];
    const Id middle = static_cast<Id>(caps.points.size());
    caps.points.push_back(centre / double(face.size()));
    for (std::size_t k = 0; k < face.size(); ++k)
      caps.triangles.push_back({face[k], face[(k + 1) % face.size()], middle});
  }
  return caps;
}

double longestEdge(const Caps& caps, const std::array<Id, 3>& t) {
  double longest = 0;
  for (int k = 0; k < 3; ++k)
    longest = std::max(longest, (caps.points[t[k]] - caps.points[t[(k + 1) % 3]]).norm());
  return longest;
}

/// Only triangles within reach of a hole's membrane, and the points they use.
Caps nearHoles(const Caps& caps, const std::vector<const Leak*>& holes, double reach) {
  const std::unique_ptr<SurfaceModel> membranes = withMembranes({}, {}, holes);
  std::vector<std::uint8_t> keep(caps.triangles.size());
  tbb::parallel_for(std::size_t(0), caps.triangles.size(), [&](std::size_t i) {
    const auto& t = caps.triangles[i];
    const Vec3 centre = (caps.points[t[0]] + caps.points[t[1]] + caps.points[t[2]]) / 3;
    keep[i] = std::sqrt(membranes->closest(centre).distance2) <= reach + longestEdge(caps, t);
  });
  Caps out;
  out.coarseSize = caps.coarseSize;
  std::vector<Id> number(caps.points.size(), kNone);
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (!keep[i]) continue;
    std::array<Id, 3> ids;
    for (int k = 0; k < 3; ++k) {
      Id& n = number[caps.triangles[i][k]];
      if (n == kNone) {
        n = static_cast<Id>(out.points.size());
        out.points.push_back(caps.points[caps.triangles[i][k]]);
      }
      ids[k] = n;
    }
    out.triangles.push_back(ids);
  }
  return out;
}

std::vector<Vec3> normalsOf(const Caps& caps) {
  std::vector<Vec3> normals(caps.points.size(), Vec3::Zero());
  for (const auto& t : caps.triangles) {
    const Vec3 n = (caps.points[t[1]] - caps.points[t[0]]).cross(caps.points[t[2]] - caps.points[t[0]]);
    for (Id p : t) normals[p] += n;
  }
  for (Vec3& n : normals) n.normalize();
  return normals;
}

// Which points go to the geometry before the others relax: those near it, and, as coarse faces are chords,
// those behind sound geometry. Points over a hole see its rim first, and from the side.
std::vector<std::uint8_t> pointsToHold(const Caps& caps, const SurfaceModel& surface, double near) {
  constexpr double kFacing = 0.9;   // cosine
  constexpr double kDeepest = 0.4;  // of a coarse cell: faces that reach over the rim dip into the room
  const std::vector<Vec3> normals = normalsOf(caps);
  std::vector<std::uint8_t> held(caps.points.size());
  tbb::parallel_for(std::size_t(0), held.size(), [&](std::size_t i) {
    const Closest c = surface.closest(caps.points[i]);
    const double distance = std::sqrt(c.distance2);
    const Vec3 way = c.point - caps.points[i];
    held[i] = distance <= near ||
              (distance <= kDeepest * caps.coarseSize && way.dot(normals[i]) >= kFacing * distance &&
               std::abs(way.dot(surface.normal(c.triangle))) >= kFacing * distance);
  });
  return held;
}

// The coarse wall bulges into the room where a hole leaves it nothing to lie on.
void settle(Caps& caps, const SurfaceModel& surface, double near, Monitor& monitor) {
  const std::vector<std::uint8_t> held = pointsToHold(caps, surface, near);
  Membrane film;
  film.points.swap(caps.points);
  film.triangles.swap(caps.triangles);
  constexpr int mostRounds = 10;
  constexpr double still = 0.02;  // of `near`
  for (int round = 0; round < mostRounds; ++round) {
    const std::vector<Vec3> before = film.points;
    relax(film, surface, 0, monitor, held);
    double moved = 0;
    for (std::size_t i = 0; i < before.size(); ++i)
      moved = std::max(moved, (film.points[i] - before[i]).norm());
    if (moved < still * near) break;
  }
  caps.points.swap(film.points);
  caps.triangles.swap(film.triangles);
}

/// The wall around the holes, in triangles as fine as asked for.
Caps fineNearHoles(const Caps& wall, const std::vector<const Leak*>& holes, double reach, double finest) {
  constexpr int mostSplits = 6;
  Caps caps = nearHoles(wall, holes, reach);
  for (int split = 0; split < mostSplits; ++split) {
    double longest = 0;
    for (const auto& t : caps.triangles) longest = std::max(longest, longestEdge(caps, t));
    if (longest <= finest) break;
    quarter(caps.points, caps.triangles);
    caps = nearHoles(caps, holes, reach);
  }
  return caps;
}

// A coarse room may be no more than a cell far from the hole.
bool coversAll(const Caps& caps, const std::vector<const Leak*>& holes, double reach) {
  return std::none_of(holes.begin(), holes.end(),
                      [&](const Leak* hole) { return nearHoles(caps, {hole}, reach).triangles.empty(); });
}

// A point near the geometry goes to its far side, measured from the closest triangle; one over a hole moves
// along the wall's own normal, so that the cap does not fold onto the rim, and the less the farther it is
// from the rim: no cell has to be kept from passing there, and a room behind a wide opening keeps its volume.
void offset(Caps& caps, const SurfaceModel& model, double distance, double over) {
  constexpr double fades = 2;  // times `over`
  const std::vector<Vec3> normals = normalsOf(caps);
  tbb::parallel_for(std::size_t(0), caps.points.size(), [&](std::size_t i) {
    const Closest c = model.closest(caps.points[i]);
    const double beyond = std::sqrt(c.distance2) - over;
    Vec3 n = normals[i];
    if (beyond <= 0) {
      const Vec3& own = model.normal(c.triangle);
      caps.points[i] = c.point;
      n = own.dot(n) < 0 ? Vec3(-own) : own;
    }
    caps.points[i] += distance * std::clamp(1 - beyond / (fades * over), 0.0, 1.0) * n;
  });
}

// Cells larger than the widest hole seal for certain; where they are too large for the room, somewhat smaller
// ones that happen to seal will do. No cells seal an opening as wide as its room, and the wall of coarse ones
// does not reach into a hole's corners: there the coarse mesh ends at the membranes. Where it cannot, caps
// that seal in part are the result.
Caps coarsestThatWorks(const SurfaceModel& model, const OctreeDecomposeOptions& options,
                       const OffsetOptions& wanted, const InsideTest& inside,
                       const std::vector<const Leak*>& holes, Monitor& monitor) {
  const auto made = [&](const SurfaceModel& surface, double size) {
    Caps wall = wallOf(coarseMesh(surface, options, size, inside, monitor));
    wall.coarseSize = size;
    Caps caps = fineNearHoles(wall, holes, std::max(size, wanted.overlap), wanted.finest);
    settle(caps, surface, wanted.finest, monitor);
    caps = nearHoles(caps, holes, wanted.overlap);
    offset(caps, model, wanted.offset, wanted.finest);
    if (!coversAll(caps, holes, wanted.overlap)) throw RegionError("the cells do not reach every hole");
    return caps;
  };
  double size = wanted.coarseSize;
  Caps last;
  for (double factor : {1.0, 0.8, 0.65, 0.5}) try {
      size = factor * wanted.coarseSize;
      if (size >= model.bounds().size().maxCoeff()) continue;
      last = made(model, size);
      if (wanted.seals(last)) return last;
    } catch (const RegionError&) {
      continue;
    }
  constexpr double coarser = 2;
  size = std::min(size, coarser * wanted.finest);
  try {
    return made(*withMembranes(model.points(), model.triangles(), holes), size);
  } catch (const RegionError& error) {
    if (!last.triangles.empty()) return last;
    throw RegionError(
        fmt::format("The holes cannot be covered from behind: neither cells of {:.4g}, which seal the "
                    "widest, nor cells of "
                    "{:.4g} up to the membranes mesh the room ({}). Close holes coarse to fine, or give a "
                    "smaller maximum "
                    "width.",
                    wanted.coarseSize, size, error.what()));
  }
}

}  // namespace

Caps offsetCaps(const SurfaceModel& model, const OctreeDecomposeOptions& octree, const OffsetOptions& options,
                const InsideTest& inside, const std::vector<const Leak*>& holes, Monitor& monitor) {
  Box near = options.rooms;
  near.lo.array() -= options.coarseSize;
  near.hi.array() += options.coarseSize;
  Trials trials(monitor);
  return coarsestThatWorks(*within(near, model), octree, options, inside, holes, trials);
}

}  // namespace pm
