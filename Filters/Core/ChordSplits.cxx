// SPDX-License-Identifier: BSD-3-Clause
#include "ChordSplits.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <map>
#include <set>

#include "DisjointSets.h"
#include "NodeMover.h"
#include "SubMesh.h"

namespace pm {
namespace {

// Of an edge's middle, in length scales: from where on it is off the geometry; the same where both ends may
// still shift, which halves it (see WallFit); and from where on it is no chord but a web across a gap.
constexpr double kOff = 0.05, kOffWhereFree = 0.1, kFarthest = 0.4;
// Parts of a new node's way that are tried, and of those its base goes with it.
constexpr double kWays[] = {1.0, 0.75, 0.5}, kFollows[] = {0.5, 1.0, 0.0};

/// How a chord's split is tried, one after the other.
enum class Attempt : std::uint8_t {
  AcrossStrips,   ///< columns between two new nodes are split along the line between them
  AcrossColumns,  ///< and those with one new node from there to an opposite one
  EdgeAlone,
  Hopeless
};

struct Chord {
  WallPlace edge;
  Id faces[2];  // beside it
  Vec3 target;
  Id curve;  // that both ends lie on, kNone: none
  Attempt attempt = Attempt::AcrossStrips;
};

/// Chords whose splits hold together, and where their new points go: node and base of each.
struct Splits {
  std::vector<Chord> chords;
  std::vector<Vec3> points;
};

class ChordSplitter {
 public:
  ChordSplitter(const PolyMesh& mesh, const BridgeSite& site, const Csr<Id>& facesOfCell)
      : mesh_(mesh),
        site_(site),
        wall_(site.wall),
        facesOfCell_(facesOfCell),
        cellsOfPoint_(pointCells(mesh, facesOfCell)) {}

  std::vector<Chord> findChords() const;
  std::vector<std::vector<Chord>> groups(const std::vector<Chord>& chords) const;
  Splits tryOut(std::vector<Chord> chords) const;
  std::vector<WallPath> pathsOf(const std::vector<Chord>& chords) const;

 private:
  void addChord(Id row, Id other, std::vector<Chord>& found) const;
  bool isOnFeature(Id row) const { return site_.held.curve[row] != kNone || site_.held.corner[row] != kNone; }
  Id commonCurve(Id row, Id other) const;
  std::vector<Id> oppositeNodes(Id face, const WallPlace& edge) const;
  std::vector<Id> cellsOf(const Chord& chord) const;
  std::vector<Id> withNeighbours(std::vector<Id> cells) const;

  const PolyMesh& mesh_;
  const BridgeSite& site_;
  const WallSurface& wall_;
  const Csr<Id>& facesOfCell_;
  Csr<Id> cellsOfPoint_;
};

/// No two share a lower edge.
std::vector<Chord> ChordSplitter::findChords() const {
  std::vector<std::vector<Chord>> ofRow(wall_.size());
  tbb::parallel_for(Id(0), wall_.size(), [&](Id row) {
    for (Id other : wall_.neighbours[row])
      if (row < other) addChord(row, other, ofRow[row]);
  });
  std::vector<Chord> chords;
  std::set<std::pair<Id, Id>> lower;
  for (const std::vector<Chord>& found : ofRow)
    for (const Chord& c : found)
      if (lower.insert(std::minmax(mesh_.base[c.edge.a], mesh_.base[c.edge.b])).second) chords.push_back(c);
  return chords;
}

void ChordSplitter::addChord(Id row, Id other, std::vector<Chord>& found) const {
  const Id a = wall_.nodes[row], b = wall_.nodes[other];
  const Vec3 middle = 0.5 * (mesh_.points[a] + mesh_.points[b]);
  const double scale = std::max(0.5 * (wall_.scale[row] + wall_.scale[other]), mesh_.finestSize);
  const Id curve = commonCurve(row, other);
  const Vec3 target =
      curve == kNone ? site_.field.closest(middle).point : site_.graph.closestOnCurve(middle, curve).point;
  const double off = (target - middle).norm() / scale;
  if (off < (isOnFeature(row) || isOnFeature(other) ? kOff : kOffWhereFree) || off > kFarthest) return;
  std::vector<Id> beside;
  for (Id f : wall_.faces[row])
    if (hasEdge(mesh_.faces[f], a, b)) beside.push_back(f);
  if (beside.size() != 2 || !canSplitColumns(mesh_, facesOfCell_, {{{a, b}}, {beside[0]}})) return;
  const Vec3 low = 0.5 * (mesh_.points[mesh_.base[a]] + mesh_.points[mesh_.base[b]]);
  if (site_.sees(low, target)) found.push_back({{a, b}, {beside[0], beside[1]}, target, curve});
}

/// The curve that both nodes lie on; kNone when there is none.
Id ChordSplitter::commonCurve(Id row, Id other) const {
  const auto lies = [&](Id r, Id curve) {
    const FeatureCurve& c = site_.graph.curves()[curve];
    const Id corner = site_.held.corner[r];
    return site_.held.curve[r] == curve ||
           (corner != kNone && (c.startCorner == corner || c.endCorner == corner));
  };
  for (Id curve : {site_.held.curve[row], site_.held.curve[other]})
    if (curve != kNone && lies(row, curve) && lies(other, curve)) return curve;
  return kNone;
}

/// The cells around a chord and its lower edge: those that its split changes.
std::vector<Id> ChordSplitter::cellsOf(const Chord& chord) const {
  std::vector<Id> cells;
  const auto addShared = [&](Id p, Id q) {
    const Span<Id> x = cellsOfPoint_[p], y = cellsOfPoint_[q];
    std::set_intersection(x.begin(), x.end(), y.begin(), y.end(), std::back_inserter(cells));
  };
  addShared(chord.edge.a, chord.edge.b);
  addShared(mesh_.base[chord.edge.a], mesh_.base[chord.edge.b]);
  sortUnique(cells);
  return cells;
}

/// The cells, and those across a face of them.
std::vector<Id> ChordSplitter::withNeighbours(std::vector<Id> cells) const {
  for (std::size_t i = 0, count = cells.size(); i < count; ++i)
    for (Id f : facesOfCell_[cells[i]]) {
      cells.push_back(mesh_.owner[f]);
      if (f < mesh_.internalFaces()) cells.push_back(mesh_.neighbour[f]);
    }
  sortUnique(cells);
  return cells;
}

/// Chords whose splits touch each other, directly or by others; large groups first, as they take longest.
std::vector<std::vector<Chord>> ChordSplitter::groups(const std::vector<Chord>& chords) const {
  DisjointSets sets(chords.size());
  std::vector<Id> changing(mesh_.cellCount, kNone);  // first chord whose split changes the cell
  const auto join = [&](Id chord, Id cell) {
    if (changing[cell] != kNone) sets.join(changing[cell], chord);
  };
  for (Id i = 0; i < static_cast<Id>(chords.size()); ++i)
    for (Id c : cellsOf(chords[i])) {
      if (changing[c] == kNone) changing[c] = i;
      join(i, c);
    }
  for (Id i = 0; i < static_cast<Id>(chords.size()); ++i)
    for (Id c : withNeighbours(cellsOf(chords[i]))) join(i, c);
  std::map<Id, std::vector<Chord>> ofRoot;
  for (std::size_t i = 0; i < chords.size(); ++i) ofRoot[sets.root(static_cast<Id>(i))].push_back(chords[i]);
  std::vector<std::vector<Chord>> groups;
  for (auto& [root, group] : ofRoot) groups.push_back(std::move(group));
  std::stable_sort(groups.begin(), groups.end(),
                   [](const auto& x, const auto& y) { return x.size() > y.size(); });
  return groups;
}

/// Nodes of a face that are no end of the edge, nearest to its middle first.
std::vector<Id> ChordSplitter::oppositeNodes(Id face, const WallPlace& edge) const {
  std::vector<Id> nodes;
  for (Id p : mesh_.faces[face])
    if (p != edge.a && p != edge.b) nodes.push_back(p);
  const Vec3 middle = 0.5 * (mesh_.points[edge.a] + mesh_.points[edge.b]);
  const auto way = [&](Id p) { return (mesh_.points[p] - middle).squaredNorm(); };
  std::stable_sort(nodes.begin(), nodes.end(), [&](Id p, Id q) { return way(p) < way(q); });
  return nodes;
}

/// The edges, and then the columns that are to be split with them.
std::vector<WallPath> ChordSplitter::pathsOf(const std::vector<Chord>& chords) const {
  std::vector<WallPath> paths;
  std::map<Id, std::vector<const Chord*>> ofFace;
  for (const Chord& c : chords) {
    paths.push_back({{c.edge}, {c.faces[0]}});
    for (Id f : c.faces) ofFace[f].push_back(&c);
  }
  std::set<Id> cells;
  const auto add = [&](const WallPath& path) {
    const Id cell = mesh_.owner[path.faces[0]];
    if (cells.count(cell) || !canSplitColumns(mesh_, facesOfCell_, path)) return false;
    cells.insert(cell);
    paths.push_back(path);
    return true;
  };
  for (const auto& [face, beside] : ofFace) {
    const auto is = [&](std::size_t i, Attempt attempt) { return beside[i]->attempt == attempt; };
    if (beside.size() == 2 && !is(0, Attempt::EdgeAlone) && !is(1, Attempt::EdgeAlone))
      add({{beside[0]->edge, beside[1]->edge}, {face}});
    if (beside.size() != 1 || !is(0, Attempt::AcrossColumns)) continue;
    for (Id p : oppositeNodes(face, beside[0]->edge))
      if (add({{beside[0]->edge, {p, kNone}}, {face}})) break;
  }
  return paths;
}

/// The new node towards its target, its base with it as far as that helps; false when it gets nowhere near.
bool place(NodeMover& mover, Id node, const Vec3& target) {
  const Id base = mover.mesh().base[node];
  const Vec3 from = mover.point(node), low = mover.point(base);
  for (double part : kWays)
    for (double follows : kFollows) {
      const Vec3 way = part * (target - from);
      if (mover.moveTogether({node, base}, {Vec3(from + way), Vec3(low + follows * way)})) return true;
    }
  return false;
}

Splits ChordSplitter::tryOut(std::vector<Chord> chords) const {
  std::vector<Id> cells;
  for (const Chord& c : chords)
    for (Id cell : cellsOf(c)) cells.push_back(cell);
  const SubMesh part = subMesh(mesh_, facesOfCell_, withNeighbours(std::move(cells)));
  const Csr<Id> facesOfCell = cellFaces(part.mesh);
  const Id old = static_cast<Id>(part.points.size());
  while (!chords.empty()) {
    PolyMesh trial = part.mesh;
    std::vector<WallPath> paths = pathsOf(chords);
    for (WallPath& path : paths) path = pathIn(part, path);
    splitColumns(trial, facesOfCell, paths);
    std::vector<Id> nodes, movable;
    for (Id p = old; p < static_cast<Id>(trial.points.size()); ++p) {
      movable.push_back(p);
      if (trial.base[p] != kNone) nodes.push_back(p);
    }
    NodeMover mover(trial, site_.limits, movable);
    std::vector<char> isThere(chords.size(), 0);
    for (std::size_t i = 0; i < nodes.size(); ++i) isThere[i] = place(mover, nodes[i], chords[i].target);
    bool allHold = true;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (isThere[i] && mover.holdsAround(nodes[i]) && mover.holdsAround(trial.base[nodes[i]])) continue;
      chords[i].attempt = static_cast<Attempt>(static_cast<int>(chords[i].attempt) + 1);
      allHold = false;
    }
    if (allHold) return {std::move(chords), {trial.points.begin() + old, trial.points.end()}};
    const auto isHopeless = [](const Chord& c) { return c.attempt == Attempt::Hopeless; };
    chords.erase(std::remove_if(chords.begin(), chords.end(), isHopeless), chords.end());
  }
  return {};
}

/// What holds, and the paths it is made of.
std::pair<Splits, std::vector<WallPath>> findSplits(const ChordSplitter& splitter) {
  const std::vector<std::vector<Chord>> groups = splitter.groups(splitter.findChords());
  std::vector<Splits> ofGroup(groups.size());
  tbb::parallel_for(std::size_t(0), groups.size(), [&](std::size_t i) {
    tbb::this_task_arena::isolate([&] { ofGroup[i] = splitter.tryOut(groups[i]); });
  });
  Splits all;
  for (const Splits& splits : ofGroup) {
    all.chords.insert(all.chords.end(), splits.chords.begin(), splits.chords.end());
    all.points.insert(all.points.end(), splits.points.begin(), splits.points.end());
  }
  std::vector<WallPath> paths = splitter.pathsOf(all.chords);
  return {std::move(all), std::move(paths)};
}

}  // namespace

std::vector<Id> splitChords(PolyMesh& mesh, const BridgeSite& site) {
  const Csr<Id> facesOfCell = cellFaces(mesh);
  const auto [splits, paths] = findSplits({mesh, site, facesOfCell});
  const std::size_t old = mesh.points.size();
  splitColumns(mesh, facesOfCell, paths);
  std::copy(splits.points.begin(), splits.points.end(),
            mesh.points.begin() + static_cast<std::ptrdiff_t>(old));
  std::vector<Id> curves;
  for (const Chord& c : splits.chords) curves.push_back(c.curve);
  return curves;
}

}  // namespace pm
