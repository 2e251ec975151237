// SPDX-License-Identifier: BSD-3-Clause
#include "TestMeshes.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <random>

namespace pm::testing {

PolyMesh joinCells(std::vector<Vec3> points, const std::vector<CellFaces>& cells,
                   std::vector<std::string> patchNames, std::vector<std::string> patchTypes,
                   const std::function<Id(const Face&)>& boundaryPatch) {
  struct Side {
    Id cell;
    Face face;
  };
  std::map<Face, std::vector<Side>> sides;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    for (const Face& face : cells[c]) {
      Face key = face;
      std::sort(key.begin(), key.end());
      sides[key].push_back({static_cast<Id>(c), face});
    }
  }
  PolyMesh mesh;
  mesh.points = std::move(points);
  mesh.cellCount = static_cast<Id>(cells.size());
  for (const bool inner : {true, false}) {
    for (const auto& [key, users] : sides) {
      if ((users.size() == 2) != inner) continue;
      mesh.faces.push(users[0].face);
      mesh.owner.push_back(users[0].cell);
      if (inner) {
        mesh.neighbour.push_back(users[1].cell);
      } else {
        mesh.patch.push_back(boundaryPatch(users[0].face));
      }
    }
  }
  mesh.patchNames = std::move(patchNames);
  mesh.patchTypes = std::move(patchTypes);
  mesh.level.assign(mesh.cellCount, 0);
  mesh.layer.assign(mesh.cellCount, 0);
  mesh.fixed.assign(mesh.points.size(), 0);
  mesh.base.assign(mesh.points.size(), kNone);
  mesh.finestSize = 1;
  canonicalise(mesh);
  return mesh;
}

CellFaces prism(const std::vector<Id>& bottom, const std::vector<Id>& top) {
  const std::size_t n = bottom.size();
  CellFaces faces{top, Face(bottom.rbegin(), bottom.rend())};
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i + 1) % n;
    faces.push_back({bottom[i], bottom[j], top[j], top[i]});
  }
  return faces;
}

namespace {

using Index = std::array<int, 3>;

/// Builds layeredVoxels step by step.
class VoxelBuilder {
 public:
  explicit VoxelBuilder(const VoxelOptions& options) : o_(options) {}

  PolyMesh build() {
    forEachVoxel([&](const Index& v) { addCore(v); });
    const std::size_t cores = cells_.size();
    forEachFreeFace([&](const Index& v, int side) {
      if (isWall(v, side)) normalsAt(v, side);
    });
    forEachFreeFace([&](const Index& v, int side) {
      if (isWall(v, side)) addPrism(v, side);
    });
    std::vector<std::string> names{"wall", "xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
    std::vector<std::string> types{"wall", "patch", "patch", "patch", "patch", "patch", "patch"};
    const std::vector<Vec3> undeformed = points_;
    PolyMesh mesh =
        joinCells(points_, cells_, names, types, [&](const Face& f) { return patchOf(f, undeformed); });
    std::fill(mesh.layer.begin() + static_cast<long>(cores), mesh.layer.end(), std::uint8_t(1));
    for (const auto& [lower, wall] : wallOf_) mesh.base[wall] = lower;
    for (std::size_t p = 0; p < points_.size(); ++p) {
      mesh.points[p] = o_.deform(points_[p]);
      for (int side = 0; side < 6; ++side) {
        if (onDomainSide(undeformed[p], side)) mesh.fixed[p] |= std::uint8_t(1 << (side / 2));
      }
    }
    mesh.stage = Stage::Layer;
    return mesh;
  }

 private:
  bool occupied(const Index& v) const {
    for (int a = 0; a < 3; ++a) {
      if (v[a] < 0 || v[a] >= o_.size[a]) return false;
    }
    return o_.occupied(v[0], v[1], v[2]);
  }
  template <class Body>
  void forEachVoxel(const Body& body) const {
    for (int k = 0; k < o_.size[2]; ++k) {
      for (int j = 0; j < o_.size[1]; ++j) {
        for (int i = 0; i < o_.size[0]; ++i) {
          if (occupied({i, j, k})) body(Index{i, j, k});
        }
      }
    }
  }
  template <class Body>
  void forEachFreeFace(const Body& body) const {
    forEachVoxel([&](const Index& v) {
      for (int side = 0; side < 6; ++side) {
        Index next = v;
        next[side / 2] += side % 2 ? 1 : -1;
        if (!occupied(next)) body(v, side);
      }
    });
  }
  bool isWall(const Index& v, int side) const {
    const bool atEnd = v[side / 2] == (side % 2 ? o_.size[side / 2] - 1 : 0);
    return !atEnd || o_.wallSide[side];
  }
  bool onDomainSide(const Vec3& p, int side) const {
    return !o_.wallSide[side] && p[side / 2] == (side % 2 ? o_.size[side / 2] : 0);
  }
  Id patchOf(const Face& face, const std::vector<Vec3>& points) const {
    for (int side = 0; side < 6; ++side) {
      if (std::all_of(face.begin(), face.end(), [&](Id p) { return onDomainSide(points[p], side); })) {
        return 1 + side;
      }
    }
    return 0;
  }
  Id node(const Index& n) {
    const auto [at, added] = nodes_.try_emplace(n, static_cast<Id>(points_.size()));
    if (added) points_.emplace_back(n[0], n[1], n[2]);
    return at->second;
  }
  /// Corners of a voxel's side, counter-clockwise from outside.
  std::vector<Index> corners(const Index& v, int side) const {
    const int a = side / 2, b = (a + 1) % 3, c = (a + 2) % 3;
    std::vector<Index> corners(4, v);
    for (Index& n : corners) n[a] += side % 2;
    corners[1][b] += 1, corners[2][b] += 1, corners[2][c] += 1, corners[3][c] += 1;
    if (side % 2 == 0) std::reverse(corners.begin(), corners.end());
    return corners;
  }
  Face face(const Index& v, int side) {
    Face row;
    for (const Index& n : corners(v, side)) row.push_back(node(n));
    return row;
  }
  void addCore(const Index& v) {
    CellFaces faces;
    for (int side = 0; side < 6; ++side) faces.push_back(face(v, side));
    cells_.push_back(faces);
  }
  /// Offset direction of a front node: the sum of the different normals of its wall faces.
  void normalsAt(const Index& v, int side) {
    for (Id p : face(v, side))
      offset_.try_emplace(p, Vec3::Zero()).first->second[side / 2] = side % 2 ? 1 : -1;
  }
  void addPrism(const Index& v, int side) {
    const Face bottom = face(v, side);
    Face top;
    for (Id p : bottom) {
      const auto [at, added] = wallOf_.try_emplace(p, static_cast<Id>(points_.size()));
      if (added) points_.push_back(points_[p] + o_.thickness * offset_[p]);
      top.push_back(at->second);
    }
    cells_.push_back(prism(bottom, top));
  }

  const VoxelOptions& o_;
  std::vector<Vec3> points_;
  std::vector<CellFaces> cells_;
  std::map<Index, Id> nodes_;
  std::map<Id, Vec3> offset_;
  std::map<Id, Id> wallOf_;
};

}  // namespace

PolyMesh layeredVoxels(const VoxelOptions& options) { return VoxelBuilder(options).build(); }

PolyMesh layeredPolygons(const std::vector<std::array<double, 2>>& points, const std::vector<Face>& polygons,
                         double height) {
  const Id n = static_cast<Id>(points.size());
  std::vector<Vec3> all;
  for (double z : {-1.0, 0.0, height}) {
    for (const auto& p : points) all.emplace_back(p[0], p[1], z);
  }
  const auto raised = [&](const Face& polygon, Id level) {
    Face row = polygon;
    for (Id& p : row) p += level * n;
    return row;
  };
  std::vector<CellFaces> cells;
  for (const Face& polygon : polygons) cells.push_back(prism(polygon, raised(polygon, 1)));
  for (const Face& polygon : polygons) cells.push_back(prism(raised(polygon, 1), raised(polygon, 2)));
  const auto isTop = [&](Id p) { return p >= 2 * n; };
  PolyMesh mesh = joinCells(all, cells, {"top", "sides"}, {"wall", "patch"},
                            [&](const Face& f) { return std::all_of(f.begin(), f.end(), isTop) ? 0 : 1; });
  std::fill(mesh.layer.begin() + static_cast<long>(polygons.size()), mesh.layer.end(), std::uint8_t(1));
  for (Id p = 2 * n; p < 3 * n; ++p) mesh.base[p] = p - n;
  mesh.stage = Stage::Layer;
  return mesh;
}

PolyMesh mergeWallPoints(const PolyMesh& mesh, Id kept, Id gone) {
  PolyMesh out = mesh;
  out.faces.clear();
  out.owner.clear();
  out.neighbour.clear();
  out.patch.clear();
  const auto renamed = [&](Id p) { return p == gone ? kept : p > gone ? p - 1 : p; };
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    Face row;
    for (Id p : mesh.faces[f]) row.push_back(renamed(p));
    row.erase(std::unique(row.begin(), row.end()), row.end());
    if (row.front() == row.back()) row.pop_back();
    if (row.size() < 3) continue;
    out.faces.push(row);
    out.owner.push_back(mesh.owner[f]);
    if (f < mesh.internalFaces()) {
      out.neighbour.push_back(mesh.neighbour[f]);
    } else {
      out.patch.push_back(mesh.patch[f - mesh.internalFaces()]);
    }
  }
  out.points.erase(out.points.begin() + gone);
  out.fixed.erase(out.fixed.begin() + gone);
  out.base.erase(out.base.begin() + gone);
  for (Id& b : out.base) b = b == kNone ? kNone : renamed(b);
  canonicalise(out);
  return out;
}

PolyMesh shuffled(const PolyMesh& mesh, unsigned seed) {
  std::mt19937 random(seed);
  const Id internal = mesh.internalFaces();
  std::vector<Id> order(mesh.faceCount());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.begin() + internal, random);
  std::shuffle(order.begin() + internal, order.end(), random);
  PolyMesh out = mesh;
  out.faces.clear();
  for (Id i = 0; i < mesh.faceCount(); ++i) {
    Face row(mesh.faces[order[i]].begin(), mesh.faces[order[i]].end());
    out.owner[i] = mesh.owner[order[i]];
    if (i < internal) out.neighbour[i] = mesh.neighbour[order[i]];
    if (i >= internal) out.patch[i - internal] = mesh.patch[order[i] - internal];
    if (i < internal && random() % 2) {
      std::reverse(row.begin(), row.end());
      std::swap(out.owner[i], out.neighbour[i]);
    }
    std::rotate(row.begin(), row.begin() + random() % row.size(), row.end());
    out.faces.push(row);
  }
  return out;
}

}  // namespace pm::testing
