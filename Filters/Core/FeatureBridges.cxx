// SPDX-License-Identifier: BSD-3-Clause
#include "FeatureBridges.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <optional>
#include <tuple>

#include "FeatureSnapper.h"
#include "ForcedMove.h"
#include "NodeMover.h"
#include "SubMesh.h"

namespace pm {
namespace {

constexpr double kShortest = 0.3, kLongest = 3;  // length scales along the curve that a bridge may span
constexpr double kFarthest = 1.2;                // and a new node may have to go
constexpr std::size_t kTrials = 3;               // paths tried for one gap

/// Two nodes, one after the other on a curve, and their places on it.
struct Gap {
  Id curve, from, to;  // wall rows
  double start, end;   // arc lengths
};

struct Proposal {
  double cost;  // length scales
  WallPath path;
  std::vector<Vec3> targets;  // of the new nodes
};

/// What is to be done to the mesh.
struct Bridge {
  Id curve = kNone;
  WallPath path;
  std::vector<Id> cells, changed;          // that it was tried out in; those of points that could move
  std::vector<std::pair<Id, Vec3>> moved;  // points and where they go
  std::vector<Vec3> added;                 // where the new points go, in the order of splitColumns()
};

class BridgeBuilder {
 public:
  BridgeBuilder(const PolyMesh& mesh, const BridgeSite& site)
      : mesh_(mesh),
        site_(site),
        wall_(site.wall),
        table_(site.graph),
        facesOfCell_(cellFaces(mesh)),
        cellsOfPoint_(pointCells(mesh, facesOfCell_)) {}

  const Csr<Id>& facesOfCell() const { return facesOfCell_; }
  std::vector<Gap> findGaps() const;
  std::optional<Bridge> build(const Gap& gap) const;

 private:
  std::vector<Proposal> propose(const Gap& gap) const;
  void extend(const Gap& gap, WallPath& path, std::vector<Proposal>& found) const;
  void finish(const Gap& gap, const WallPath& path, std::vector<Proposal>& found) const;
  Id across(Id face, const WallPlace& edge) const;
  std::vector<Id> cellsAround(const WallPath& path) const;
  std::optional<Bridge> tryOut(const Gap& gap, const Proposal& proposal) const;
  FeaturePaths targetsIn(const SubMesh& part, const Gap& gap, const Proposal& proposal) const;

  const PolyMesh& mesh_;
  const BridgeSite& site_;
  const WallSurface& wall_;
  CurveTable table_;
  Csr<Id> facesOfCell_, cellsOfPoint_;
};

std::vector<Gap> BridgeBuilder::findGaps() const {
  using OnCurve = std::tuple<Id, double, Id>;  // curve, arc length, row
  std::vector<OnCurve> nodes;
  const auto& curves = site_.graph.curves();
  std::vector<std::pair<Id, Id>> atCorner;  // corner, row
  for (Id row = 0; row < wall_.size(); ++row) {
    if (site_.held.corner[row] != kNone) atCorner.emplace_back(site_.held.corner[row], row);
    const Id curve = site_.held.curve[row];
    if (curve == kNone) continue;
    Vec3 unused;
    const Vec3& p = mesh_.points[wall_.nodes[row]];
    nodes.emplace_back(curve, table_.project(p, site_.graph.closestOnCurve(p, curve).segment, unused), row);
  }
  std::sort(atCorner.begin(), atCorner.end());
  const auto addCorner = [&](Id curve, Id corner, double arc) {
    auto it = std::lower_bound(atCorner.begin(), atCorner.end(), std::pair<Id, Id>(corner, 0));
    for (; corner != kNone && it != atCorner.end() && it->first == corner; ++it)
      nodes.emplace_back(curve, arc, it->second);
  };
  for (Id c = 0; c < static_cast<Id>(curves.size()); ++c) {
    addCorner(c, curves[c].startCorner, 0);
    addCorner(c, curves[c].endCorner, table_.length(c));
  }
  std::sort(nodes.begin(), nodes.end());
  std::vector<Gap> gaps;
  const auto add = [&](Id curve, Id a, Id b, double start, double end) {
    const double scale = std::max(wall_.scale[a], wall_.scale[b]);
    const Span<Id> beside = wall_.neighbours[a];
    if (a == b || end - start < kShortest * scale || end - start > kLongest * scale ||
        std::binary_search(beside.begin(), beside.end(), b))
      return;
    gaps.push_back({curve, a, b, start, end});
  };
  for (std::size_t i = 0, first = 0; i < nodes.size(); ++i) {
    const auto& [curve, arc, row] = nodes[i];
    const bool last = i + 1 == nodes.size() || std::get<0>(nodes[i + 1]) != curve;
    if (!last)
      add(curve, row, std::get<2>(nodes[i + 1]), arc, std::get<1>(nodes[i + 1]));
    else if (curves[curve].closed)
      add(curve, row, std::get<2>(nodes[first]), arc, std::get<1>(nodes[first]) + table_.length(curve));
    if (last) first = i + 1;
  }
  return gaps;
}

/// The wall face on the other side of an edge; kNone where there is none of another cell.
Id BridgeBuilder::across(Id face, const WallPlace& edge) const {
  for (Id f : wall_.faces[wall_.rowOf[edge.a]])
    if (mesh_.owner[f] != mesh_.owner[face] && hasEdge(mesh_.faces[f], edge.a, edge.b)) return f;
  return kNone;
}

/// Paths from the last place of this one, over its last face, to the end of the gap.
void BridgeBuilder::extend(const Gap& gap, WallPath& path, std::vector<Proposal>& found) const {
  const Id face = path.faces.back(), end = wall_.nodes[gap.to];
  const Span<Id> row = mesh_.faces[face];
  const WallPlace from = path.places.back();
  if (std::find(row.begin(), row.end(), end) != row.end()) {
    path.places.push_back({end, kNone});
    finish(gap, path, found);
    path.places.pop_back();
    return;
  }
  constexpr std::size_t kMostNew = 2;
  if (path.places.size() > kMostNew) return;
  for (std::size_t k = 0; k < row.size(); ++k) {
    const WallPlace edge{row[k], row[(k + 1) % row.size()]};
    if (edge.a == from.a || edge.b == from.a) {
      if (!from.isNew() || edge.a == from.b || edge.b == from.b) continue;
    }
    const Id next = across(face, edge);
    if (next == kNone) continue;
    path.places.push_back(edge);
    path.faces.push_back(next);
    extend(gap, path, found);
    path.faces.pop_back();
    path.places.pop_back();
  }
}

void BridgeBuilder::finish(const Gap& gap, const WallPath& path, std::vector<Proposal>& found) const {
  constexpr double kNew = 0.5;  // cost of a node
  if (!canSplitColumns(mesh_, facesOfCell_, path)) return;
  Proposal proposal{0, path, {}};
  const double scale = wall_.scale[gap.from];
  const double step = (gap.end - gap.start) / static_cast<double>(path.places.size() - 1);
  for (std::size_t i = 1; i + 1 < path.places.size(); ++i) {
    const WallPlace& edge = path.places[i];
    const Vec3 target = table_.at(gap.curve, gap.start + static_cast<double>(i) * step);
    const double way = (0.5 * (mesh_.points[edge.a] + mesh_.points[edge.b]) - target).norm() / scale;
    const Vec3 low = 0.5 * (mesh_.points[mesh_.base[edge.a]] + mesh_.points[mesh_.base[edge.b]]);
    if (way > kFarthest || !site_.sees(low, target)) return;
    proposal.cost += way + kNew;
    proposal.targets.push_back(target);
  }
  found.push_back(std::move(proposal));
}

std::vector<Proposal> BridgeBuilder::propose(const Gap& gap) const {
  std::vector<Proposal> found;
  for (Id f : wall_.faces[gap.from]) {
    WallPath path{{{wall_.nodes[gap.from], kNone}}, {f}};
    extend(gap, path, found);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Proposal& x, const Proposal& y) { return x.cost < y.cost; });
  if (found.size() > kTrials) found.resize(kTrials);
  return found;
}

/// Two rings of cells around those that the path splits: the outer one is not changed.
std::vector<Id> BridgeBuilder::cellsAround(const WallPath& path) const {
  std::vector<Id> cells;
  for (Id f : path.faces) cells.push_back(mesh_.owner[f]);
  for (int ring = 0; ring < 2; ++ring) {
    std::vector<Id> points;
    for (Id c : cells)
      for (Id f : facesOfCell_[c]) points.insert(points.end(), mesh_.faces[f].begin(), mesh_.faces[f].end());
    sortUnique(points);
    cells.clear();
    for (Id p : points) cells.insert(cells.end(), cellsOfPoint_[p].begin(), cellsOfPoint_[p].end());
    sortUnique(cells);
  }
  return cells;
}

/// Points of no cell along which the part was cut out.
std::vector<Id> innerPoints(const SubMesh& part, const Csr<Id>& facesOfCell) {
  const Id cut = static_cast<Id>(part.mesh.patchNames.size()) - 1, internal = part.mesh.internalFaces();
  std::vector<char> outer(part.points.size(), 0);
  for (Id c = 0; c < part.mesh.cellCount; ++c) {
    const Span<Id> faces = facesOfCell[c];
    const auto isCut = [&](Id f) { return f >= internal && part.mesh.patch[f - internal] == cut; };
    if (std::none_of(faces.begin(), faces.end(), isCut)) continue;
    for (Id f : faces)
      for (Id p : part.mesh.faces[f]) outer[p] = 1;
  }
  std::vector<Id> points;
  for (std::size_t p = 0; p < outer.size(); ++p)
    if (!outer[p]) points.push_back(static_cast<Id>(p));
  return points;
}

/// Nodes on features stay on them; the new ones go to the curve.
FeaturePaths BridgeBuilder::targetsIn(const SubMesh& part, const Gap& gap, const Proposal& proposal) const {
  const std::size_t oldPoints = part.points.size();
  FeaturePaths paths;
  for (std::size_t p = 0; p < oldPoints; ++p) {
    const Id row = wall_.rowOf[part.points[p]];
    if (row == kNone) continue;
    const Id curve = site_.held.curve[row], corner = site_.held.corner[row];
    if (curve != kNone || corner != kNone)
      paths.targets.push_back(
          {static_cast<Id>(p), corner == kNone ? curve : kNone, corner, part.mesh.points[p]});
  }
  std::vector<Id> piece{part.pointOf(wall_.nodes[gap.from])};
  for (std::size_t i = 0; i < proposal.targets.size(); ++i) {
    piece.push_back(static_cast<Id>(oldPoints + 2 * i));
    paths.targets.push_back({piece.back(), gap.curve, kNone, proposal.targets[i]});
  }
  piece.push_back(part.pointOf(wall_.nodes[gap.to]));
  paths.pieces.push(piece);
  paths.pieceCurve.push_back(gap.curve);
  return paths;
}

/// A split may leave measures outside their limits that no node on the curve is to blame for: the points
/// there that are off the wall give way.
void mendSplit(NodeMover& mover, const WallSurface& wall, const std::vector<Id>& points) {
  constexpr int kSweeps = 3;
  const ForcedMove forced(mover, wall);
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (Id p : points)
      if (wall.rowOf[p] == kNone && !mover.holdsAround(p))
        forced.mendInner(p, mover.neighbourMean(p), mover.mesh().finestSize);
}

std::optional<Bridge> BridgeBuilder::tryOut(const Gap& gap, const Proposal& proposal) const {
  SubMesh part = subMesh(mesh_, facesOfCell_, cellsAround(proposal.path));
  const Csr<Id> faces = cellFaces(part.mesh);
  const std::vector<Id> inner = innerPoints(part, faces);
  splitColumns(part.mesh, faces, {pathIn(part, proposal.path)});
  std::vector<Id> movable = inner;
  for (std::size_t p = part.points.size(); p < part.mesh.points.size(); ++p)
    movable.push_back(static_cast<Id>(p));

  NodeMover mover(part.mesh, site_.limits, movable);
  const WallSurface wall = wallSurface(part.mesh);
  const std::vector<double> height = prismHeights(part.mesh, wall);
  FeatureSnapper snapper(mover, wall, site_.field, site_.graph, height);
  snapper.setTargets(targetsIn(part, gap, proposal));
  snapper.snap(false);
  snapper.force();
  if (!snapper.missed().empty()) return {};
  mendSplit(mover, wall, movable);
  for (Id p : movable)
    if (!mover.holdsAround(p)) return {};
  Bridge bridge{gap.curve, proposal.path, part.cells, {}, {}, {}};
  for (Id p : inner) {
    const Id whole = part.points[p];
    const Span<Id> cells = cellsOfPoint_[whole];
    bridge.changed.insert(bridge.changed.end(), cells.begin(), cells.end());
    if (part.mesh.points[p] != mesh_.points[whole]) bridge.moved.emplace_back(whole, part.mesh.points[p]);
  }
  sortUnique(bridge.changed);
  bridge.added.assign(part.mesh.points.begin() + static_cast<std::ptrdiff_t>(part.points.size()),
                      part.mesh.points.end());
  return bridge;
}

std::optional<Bridge> BridgeBuilder::build(const Gap& gap) const {
  for (const Proposal& proposal : propose(gap))
    if (std::optional<Bridge> bridge = tryOut(gap, proposal)) return bridge;
  return {};
}

/// Of bridges of which one changes what another has looked at, the first.
std::vector<Bridge> independent(std::vector<std::optional<Bridge>>& bridges, Id cellCount) {
  enum Mark : char { Untouched, LookedAt, Changed };
  std::vector<Mark> marks(cellCount, Untouched);
  std::vector<Bridge> chosen;
  for (std::optional<Bridge>& bridge : bridges) {
    if (!bridge) continue;
    const auto isChanged = [&](Id c) { return marks[c] == Changed; };
    const auto isTouched = [&](Id c) { return marks[c] != Untouched; };
    if (std::any_of(bridge->cells.begin(), bridge->cells.end(), isChanged) ||
        std::any_of(bridge->changed.begin(), bridge->changed.end(), isTouched))
      continue;
    for (Id c : bridge->cells) marks[c] = LookedAt;
    for (Id c : bridge->changed) marks[c] = Changed;
    chosen.push_back(std::move(*bridge));
  }
  return chosen;
}

/// #P is the point in a cell that a bridge changes?
std::vector<char> changedPoints(const PolyMesh& mesh, const Csr<Id>& facesOfCell,
                                const std::vector<Bridge>& bridges) {
  std::vector<char> changed(mesh.points.size(), 0);
  for (const Bridge& bridge : bridges)
    for (Id c : bridge.changed)
      for (Id f : facesOfCell[c])
        for (Id p : mesh.faces[f]) changed[p] = 1;
  return changed;
}

}  // namespace

BridgesBuilt bridgeGaps(PolyMesh& mesh, const BridgeSite& site, std::set<GapKey>& hopeless) {
  const BridgeBuilder builder(mesh, site);
  const auto key = [&](const Gap& gap) {
    return GapKey{gap.curve, site.wall.nodes[gap.from], site.wall.nodes[gap.to]};
  };
  std::vector<Gap> gaps = builder.findGaps();
  gaps.erase(std::remove_if(gaps.begin(), gaps.end(), [&](const Gap& g) { return hopeless.count(key(g)); }),
             gaps.end());
  std::vector<std::optional<Bridge>> bridges(gaps.size());
  tbb::parallel_for(std::size_t(0), gaps.size(), [&](std::size_t i) {
    tbb::this_task_arena::isolate([&] { bridges[i] = builder.build(gaps[i]); });
  });
  std::size_t found = 0;
  for (std::size_t i = 0; i < gaps.size(); ++i)
    if (bridges[i])
      ++found;
    else
      hopeless.insert(key(gaps[i]));
  const std::vector<Bridge> chosen = independent(bridges, mesh.cellCount);
  const std::vector<char> changed = changedPoints(mesh, builder.facesOfCell(), chosen);
  BridgesBuilt built{chosen.size(), {}, chosen.size() < found};
  for (auto gap = hopeless.begin(); gap != hopeless.end();) {
    const bool again = changed[(*gap)[1]] || changed[(*gap)[2]];
    built.more |= again;
    gap = again ? hopeless.erase(gap) : std::next(gap);
  }
  std::vector<WallPath> paths;
  for (const Bridge& bridge : chosen) paths.push_back(bridge.path);
  std::size_t next = mesh.points.size();
  splitColumns(mesh, builder.facesOfCell(), paths);
  for (const Bridge& bridge : chosen) {
    for (const auto& [p, place] : bridge.moved) mesh.points[p] = place;
    for (const Vec3& place : bridge.added) mesh.points[next++] = place;
    built.curves.insert(built.curves.end(), bridge.added.size() / 2, bridge.curve);
  }
  return built;
}

}  // namespace pm
