// SPDX-License-Identifier: BSD-3-Clause
#include "WallPatches.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

#include "MeshQuality.h"

namespace pm {
namespace {

/// The two patches most samples of a face voted for.
struct Vote {
  Id best = kNone, second = kNone;
};

std::vector<Id> meshPatchOfModelPatch(const PolyMesh& mesh, const SurfaceModel& model) {
  std::vector<Id> ids;
  for (const std::string& name : model.patchNames()) {
    const auto it = std::find(mesh.patchNames.begin(), mesh.patchNames.end(), name);
    if (it == mesh.patchNames.end())
      throw InputError("The mesh has no patch named '" + name +
                       "': give the geometry the mesh was made from.");
    ids.push_back(static_cast<Id>(it - mesh.patchNames.begin()));
  }
  return ids;
}

Vote vote(const PolyMesh& mesh, const DistanceField& field, const std::vector<Id>& patchOf, Id face) {
  std::array<std::pair<Id, int>, 8> counts;
  std::size_t used = 0;
  const auto add = [&](const Vec3& p, int weight) {
    const Id patch = patchOf[field.model().patchOf(field.closest(p).triangle)];
    std::size_t i = 0;
    while (i < used && counts[i].first != patch) ++i;
    if (i == counts.size()) return;
    if (i == used) counts[used++] = {patch, 0};
    counts[i].second += weight;
  };
  const Vec3 centre = measureFace(mesh.points, mesh.faces[face], true).centre;
  add(centre, 2);
  for (Id p : mesh.faces[face]) add(0.5 * (centre + mesh.points[p]), 1);
  const auto most = [&](Id except) {
    Id patch = kNone;
    int weight = 0;
    for (std::size_t i = 0; i < used; ++i)
      if (counts[i].first != except &&
          (counts[i].second > weight || (counts[i].second == weight && counts[i].first < patch))) {
        patch = counts[i].first;
        weight = counts[i].second;
      }
    return patch;
  };
  const Id best = most(kNone);
  return {best, most(best)};
}

/// Boundary faces across each edge of the boundary faces; kNone on a rim with the domain's sides left out.
Csr<Id> facesAcross(const PolyMesh& mesh) {
  struct Edge {
    Id a, b, face;
    Id slot;
  };
  std::vector<Edge> edges;
  Csr<Id> across;
  for (Id i = 0; i < mesh.boundaryFaces(); ++i) {
    const Span<Id> row = mesh.faces[mesh.internalFaces() + i];
    for (std::size_t k = 0; k < row.size(); ++k) {
      const Id p = row[k], q = row[(k + 1) % row.size()];
      edges.push_back({std::min(p, q), std::max(p, q), i, static_cast<Id>(edges.size())});
    }
    across.offsets.push_back(static_cast<Id>(edges.size()));
  }
  across.values.assign(edges.size(), kNone);
  std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) {
    return x.a != y.a ? x.a < y.a : x.b != y.b ? x.b < y.b : x.slot < y.slot;
  });
  for (std::size_t i = 0; i + 1 < edges.size(); ++i)
    if (edges[i].a == edges[i + 1].a && edges[i].b == edges[i + 1].b) {
      across.values[edges[i].slot] = edges[i + 1].face;
      across.values[edges[i + 1].slot] = edges[i].face;
    }
  return across;
}

}  // namespace

void assignWallPatches(PolyMesh& mesh, const DistanceField& field) {
  const std::vector<Id> patchOf = meshPatchOfModelPatch(mesh, field.model());
  std::vector<Vote> votes(mesh.boundaryFaces());
  tbb::parallel_for(tbb::blocked_range<Id>(0, mesh.boundaryFaces(), 256),
                    [&](const tbb::blocked_range<Id>& range) {
                      for (Id i = range.begin(); i != range.end(); ++i)
                        if (mesh.isWallPatch(mesh.patch[i]))
                          votes[i] = vote(mesh, field, patchOf, mesh.internalFaces() + i);
                    });
  const Csr<Id> across = facesAcross(mesh);
  for (Id i = 0; i < mesh.boundaryFaces(); ++i) {
    if (votes[i].best == kNone) continue;
    mesh.patch[i] = votes[i].best;
    bool alone = votes[i].second != kNone;
    for (Id n : across[i]) alone = alone && n != kNone && votes[n].best == votes[i].second;
    if (alone) mesh.patch[i] = votes[i].second;
  }
}

}  // namespace pm
