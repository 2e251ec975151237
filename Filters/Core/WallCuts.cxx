// SPDX-License-Identifier: BSD-3-Clause
#include "WallCuts.h"

#include <algorithm>
#include <utility>

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

namespace {

/// The boundary faces of a mesh, taken out to be put back one by one, changed or not.
class BoundaryRows {
 public:
  explicit BoundaryRows(PolyMesh& mesh) : mesh_(mesh) {
    const Id internal = mesh.internalFaces();
    const Id begin = mesh.faces.offsets[internal];
    for (Id f = internal; f <= mesh.faceCount(); ++f) offsets_.push_back(mesh.faces.offsets[f] - begin);
    values_.assign(mesh.faces.values.begin() + begin, mesh.faces.values.end());
    owner_.assign(mesh.owner.begin() + internal, mesh.owner.end());
    patch_.swap(mesh.patch);
    mesh.faces.values.resize(begin);
    mesh.faces.offsets.resize(static_cast<std::size_t>(internal) + 1);
    mesh.owner.resize(internal);
  }
  Id count() const { return static_cast<Id>(owner_.size()); }
  Span<Id> row(Id i) const { return {values_.data() + offsets_[i], values_.data() + offsets_[i + 1]}; }
  /// Puts a row back in place of boundary face i.
  template <class Row>
  void add(Id i, const Row& row) {
    mesh_.faces.push(row);
    mesh_.owner.push_back(owner_[i]);
    mesh_.patch.push_back(patch_[i]);
  }

 private:
  PolyMesh& mesh_;
  std::vector<Id> offsets_, values_, owner_, patch_;
};

/// The one edge the two faces share, none when they share more or nothing.
WallMerge pairOf(const PolyMesh& mesh, Id first, Id second) {
  const Span<Id> x = mesh.faces[first], y = mesh.faces[second];
  const auto sharedPoints =
      std::count_if(x.begin(), x.end(), [&](Id p) { return std::find(y.begin(), y.end(), p) != y.end(); });
  if (sharedPoints != 2) return {};
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = 0; j < y.size(); ++j)
      if (x[i] == y[(j + 1) % y.size()] && x[(i + 1) % x.size()] == y[j])
        return {first, second, x[(i + 1) % x.size()], x[i]};
  return {};
}

using Edge = std::pair<Id, Id>;

Edge edgeOf(const WallCut& cut) { return std::minmax(cut.a, cut.b); }

/// Leaves out cuts along what is an edge of the boundary already, or that of an earlier cut: it would be in
/// four faces.
void dropKnownEdges(const PolyMesh& mesh, std::vector<WallCut>& cuts) {
  std::vector<Edge> known;
  for (const WallCut& cut : cuts) known.push_back(edgeOf(cut));
  sortUnique(known);
  std::vector<char> isEdge(known.size(), 0);
  const auto place = [&](const Edge& edge) {
    const auto it = std::lower_bound(known.begin(), known.end(), edge);
    return it != known.end() && *it == edge ? it - known.begin() : -1;
  };
  for (Id f = mesh.internalFaces(); f < mesh.faceCount(); ++f) {
    const Span<Id> row = mesh.faces[f];
    for (std::size_t k = 0; k < row.size(); ++k)
      if (const auto i = place(std::minmax(row[k], row[(k + 1) % row.size()])); i >= 0) isEdge[i] = 1;
  }
  const auto isKnown = [&](const WallCut& cut) {
    char& is = isEdge[place(edgeOf(cut))];
    return std::exchange(is, 1) != 0;
  };
  cuts.erase(std::remove_if(cuts.begin(), cuts.end(), isKnown), cuts.end());
}

}  // namespace

std::vector<WallCut> cutWallFaces(PolyMesh& mesh, std::vector<WallCut> cuts) {
  if (cuts.empty()) return cuts;
  std::stable_sort(cuts.begin(), cuts.end(),
                   [](const WallCut& x, const WallCut& y) { return x.face < y.face; });
  cuts.erase(std::unique(cuts.begin(), cuts.end(),
                         [](const WallCut& x, const WallCut& y) { return x.face == y.face; }),
             cuts.end());
  dropKnownEdges(mesh, cuts);
  BoundaryRows rows(mesh);
  std::vector<Id> first, second;
  auto cut = cuts.begin();
  for (Id i = 0; i < rows.count(); ++i) {
    const Id f = mesh.internalFaces() + i;
    while (cut != cuts.end() && cut->face < f) ++cut;
    if (cut == cuts.end() || cut->face != f) {
      rows.add(i, rows.row(i));
      continue;
    }
    cutRow(rows.row(i), cut->a, cut->b, first, second);
    rows.add(i, first);
    rows.add(i, second);
  }
  return cuts;
}

std::vector<WallMerge> wallPairs(const PolyMesh& mesh) {
  const Id internal = mesh.internalFaces();
  std::vector<std::pair<Id, Id>> byCell;
  for (Id i = 0; i < mesh.boundaryFaces(); ++i)
    if (mesh.isWallPatch(mesh.patch[i])) byCell.emplace_back(mesh.owner[internal + i], internal + i);
  std::sort(byCell.begin(), byCell.end());
  std::vector<WallMerge> pairs;
  for (std::size_t i = 0; i < byCell.size(); ++i)
    for (std::size_t j = i + 1; j < byCell.size() && byCell[j].first == byCell[i].first; ++j) {
      const Id f = byCell[i].second, g = byCell[j].second;
      if (mesh.patch[f - internal] != mesh.patch[g - internal]) continue;
      if (const WallMerge pair = pairOf(mesh, f, g); pair.first != kNone) pairs.push_back(pair);
    }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const WallMerge& x, const WallMerge& y) { return x.first < y.first; });
  return pairs;
}

std::vector<Id> mergedRow(Span<Id> first, Span<Id> second, Id a, Id b) {
  std::vector<Id> row(first.begin(), first.end());
  std::rotate(row.begin(), std::find(row.begin(), row.end(), a), row.end());
  std::vector<Id> rest(second.begin(), second.end());
  std::rotate(rest.begin(), std::find(rest.begin(), rest.end(), b), rest.end());
  row.insert(row.end(), rest.begin() + 1, rest.end() - 1);
  return row;
}

void mergeWallFaces(PolyMesh& mesh, const std::vector<WallMerge>& merges) {
  if (merges.empty()) return;
  const Id internal = mesh.internalFaces();
  std::vector<const WallMerge*> of(mesh.boundaryFaces(), nullptr);
  for (const WallMerge& m : merges)
    if (of[m.first - internal] == nullptr && of[m.second - internal] == nullptr)
      of[m.first - internal] = of[m.second - internal] = &m;
  BoundaryRows rows(mesh);
  for (Id i = 0; i < rows.count(); ++i) {
    const WallMerge* m = of[i];
    if (m == nullptr)
      rows.add(i, rows.row(i));
    else if (internal + i == std::min(m->first, m->second))
      rows.add(i, mergedRow(rows.row(m->first - internal), rows.row(m->second - internal), m->a, m->b));
  }
}

}  // namespace pm
