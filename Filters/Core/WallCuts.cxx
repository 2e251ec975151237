// SPDX-License-Identifier: BSD-3-Clause
#include "WallCuts.h"

#include <algorithm>

namespace pm {

void cutRow(Span<Id> row, Id a, Id b, std::vector<Id>& first, std::vector<Id>& second) {
  const auto part = [&](Id from, Id to, std::vector<Id>& out) {
    out.clear();
    std::size_t k = std::find(row.begin(), row.end(), from) - row.begin();
    for (; row[k] != to; k = (k + 1) % row.size()) out.push_back(row[k]);
    out.push_back(to);
  };
  part(a, b, first);
  part(b, a, second);
}

void cutWallFaces(PolyMesh& mesh, std::vector<WallCut> cuts) {
  if (cuts.empty()) return;
  std::stable_sort(cuts.begin(), cuts.end(),
                   [](const WallCut& x, const WallCut& y) { return x.face < y.face; });
  const Id internal = mesh.internalFaces(), count = mesh.faceCount();
  const auto keep = static_cast<std::size_t>(mesh.faces.offsets[internal]);
  const std::vector<Id> tail(mesh.faces.values.begin() + static_cast<std::ptrdiff_t>(keep),
                             mesh.faces.values.end());
  std::vector<Id> ends(mesh.faces.offsets.begin() + internal, mesh.faces.offsets.end());
  const std::vector<Id> owner(mesh.owner.begin() + internal, mesh.owner.end()), patch = mesh.patch;
  mesh.faces.values.resize(keep);
  mesh.faces.offsets.resize(static_cast<std::size_t>(internal) + 1);
  mesh.owner.resize(internal);
  mesh.patch.clear();

  std::vector<Id> first, second;
  auto cut = cuts.begin();
  for (Id f = internal; f < count; ++f) {
    const Id i = f - internal;
    const Span<Id> row{tail.data() + ends[i] - keep, tail.data() + ends[i + 1] - keep};
    const auto add = [&](const auto& part) {
      mesh.faces.push(part);
      mesh.owner.push_back(owner[i]);
      mesh.patch.push_back(patch[i]);
    };
    while (cut != cuts.end() && cut->face < f) ++cut;
    if (cut == cuts.end() || cut->face != f) {
      add(row);
      continue;
    }
    cutRow(row, cut->a, cut->b, first, second);
    add(first);
    add(second);
  }
}

}  // namespace pm
