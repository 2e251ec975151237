// SPDX-License-Identifier: BSD-3-Clause
#include "FeaturePaths.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "CurveTracer.h"

namespace pm {

CurveTable::CurveTable(const FeatureGraph& graph) : graph_(graph) {
  const auto& segments = graph.segments();
  const std::size_t curves = graph.curves().size();
  first_.assign(curves + 1, 0);
  length_.assign(curves, 0.0);
  arc_.resize(segments.size());
  for (std::size_t s = 0; s < segments.size(); ++s) {
    double& length = length_[segments[s].curve];
    arc_[s] = length;
    length += (segments[s].b - segments[s].a).norm();
    ++first_[segments[s].curve + 1];
  }
  for (std::size_t c = 0; c < curves; ++c) first_[c + 1] += first_[c];
}

double CurveTable::project(const Vec3& p, Id segment, Vec3& on) const {
  const FeatureSegment& s = graph_.segments()[segment];
  const Vec3 way = s.b - s.a;
  const double length2 = way.squaredNorm();
  const double t = length2 > 0 ? std::clamp((p - s.a).dot(way) / length2, 0.0, 1.0) : 0.0;
  on = s.a + t * way;
  return arc_[segment] + t * std::sqrt(length2);
}

Vec3 CurveTable::at(Id curve, double s) const {
  const double length = length_[curve];
  if (graph_.curves()[curve].closed && length > 0)
    s -= length * std::floor(s / length);
  else
    s = std::clamp(s, 0.0, length);
  const auto first = arc_.begin() + first_[curve], last = arc_.begin() + first_[curve + 1];
  const auto it = std::max(first, std::upper_bound(first, last, s) - 1);
  const FeatureSegment& segment = graph_.segments()[it - arc_.begin()];
  const double part = (segment.b - segment.a).norm();
  return segment.a + (part > 0 ? std::min(1.0, (s - *it) / part) : 0.0) * (segment.b - segment.a);
}

std::vector<Vec3> CurveTable::part(Id curve, double from, double to) const {
  std::vector<Vec3> points{at(curve, from)};
  for (Id s = firstSegment(curve); s < endSegment(curve); ++s)
    if (arc_[s] > from && arc_[s] < to) points.push_back(graph_.segments()[s].a);
  points.push_back(to < length_[curve] ? at(curve, to) : graph_.segments()[endSegment(curve) - 1].b);
  return points;
}

namespace {

struct NearCorner {
  double distance;  // length scales
  Id corner, row;
};

/// All pairs of a wall node and a curve or corner near it.
struct Neighbourhood {
  Csr<NearNode> curves;             // #curves rows, ascending by wall row
  std::vector<NearCorner> corners;  // nearest first
};

class PathFinder {
 public:
  PathFinder(const PolyMesh& mesh, const WallSurface& wall, const FeatureGraph& graph,
             const FeaturePathOptions& options, const PathHistory& history)
      : mesh_(mesh), wall_(wall), graph_(graph), options_(options), history_(history), table_(graph) {}
  FeaturePaths find();

 private:
  struct Block {
    std::vector<std::pair<Id, NearNode>> curves;
    std::vector<NearCorner> corners;
  };
  void gather();
  void gatherNode(Id row, Block& block) const;
  static void preferNearest(Block& block, std::size_t first);
  void addCorner(Id corner, Id row, Block& block) const;
  bool reachable(Id row, const Vec3& target) const;
  double penalty(Id row) const { return history_.penalty.empty() ? 0.0 : history_.penalty[row]; }
  /// Free for a curve or a corner?
  bool isFree(Id row, Id curve, Id corner) const {
    if (taken_[row].node != kNone) return false;
    if (history_.curve.empty() || (history_.curve[row] == kNone && history_.corner[row] == kNone))
      return true;
    return history_.curve[row] == curve && history_.corner[row] == corner;
  }
  void mergeCorners();
  Id findRepresentative(Id corner) const;
  void placeCorners();
  void traceCurve(CurveTracer& tracer, Id curve);
  CurveTracer::Task makeTask(Id curve, Id zone, double scale) const;
  CurveState traceInZone(CurveTracer& tracer, Id curve, Id zone, double scale);
  void findZones();
  Id& cornerRow(Id corner, Id zone) { return cornerRow_[zone * graph_.corners().size() + corner]; }
  Id cornerRow(Id corner, Id zone) const { return cornerRow_[zone * graph_.corners().size() + corner]; }
  void chooseLoopStart(CurveTracer::Task& task) const;
  double curveScale(Id curve) const;
  void keepPiece(Id curve, const std::vector<PathNode>& piece, double shift, double scale);
  std::vector<double> spread(const std::vector<PathNode>& piece, double scale, bool firstFixed,
                             bool lastFixed) const;
  void collectTargets();
  bool canCut(const WallCut& cut) const;

  const PolyMesh& mesh_;
  const WallSurface& wall_;
  const FeatureGraph& graph_;
  const FeaturePathOptions& options_;
  const PathHistory& history_;
  CurveTable table_;
  Neighbourhood near_;
  std::vector<double> cornerScale_;  // #corners length scale, 0 where no wall node is near
  std::vector<Id> representative_;   // #corners
  std::vector<Id> zone_;             // #W zone of the cells behind the wall; 0 in a mesh of one zone
  std::vector<Id> cornerRow_;        // #zones by #corners wall row
  Id zones_ = 1;
  std::vector<NodeTarget> taken_;  // #W
  std::vector<char> cut_;          // #boundary faces that a path crosses
  FeaturePaths result_;
};

/// A node on a domain side can only lie where the feature meets that side; none goes through the geometry.
bool PathFinder::reachable(Id row, const Vec3& target) const {
  const Id p = wall_.nodes[row];
  const std::uint8_t fixed = mesh_.fixed.empty() ? 0 : mesh_.fixed[p];
  for (int a = 0; a < 3; ++a)
    if ((fixed >> a & 1) && std::abs(target[a] - mesh_.points[p][a]) > 0.05 * wall_.scale[row]) return false;
  return !options_.sees || options_.sees(p, target);
}

// A path can go around a node that missed, a corner has few others to take.
constexpr double kCornerShare = 0.3;

void PathFinder::addCorner(Id corner, Id row, Block& block) const {
  if (corner == kNone) return;
  const Vec3& at = graph_.corners()[corner];
  const double d = (mesh_.points[wall_.nodes[row]] - at).norm() / wall_.scale[row];
  if (d <= options_.cornerReach && reachable(row, at))
    block.corners.push_back({d + kCornerShare * penalty(row), corner, row});
}

/// Of curves beside each other, each shall take the nodes on its side.
void PathFinder::preferNearest(Block& block, std::size_t first) {
  constexpr float kNotNearest = 1;  // extra cost over how much nearer another curve is
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t i = first; i < block.curves.size(); ++i)
    least = std::min(least, block.curves[i].second.distance);
  for (std::size_t i = first; i < block.curves.size(); ++i) {
    float& cost = block.curves[i].second.distance;
    cost += kNotNearest * (cost - least);
  }
}

void PathFinder::gatherNode(Id row, Block& block) const {
  const Vec3& p = mesh_.points[wall_.nodes[row]];
  const double scale = wall_.scale[row];
  Box box;
  const Vec3 reach = Vec3::Constant(scale * std::max(options_.reach, options_.cornerReach));
  box.add(p - reach);
  box.add(p + reach);
  const std::vector<Id> ids = graph_.segmentsNear(box);
  const auto& segments = graph_.segments();
  const std::size_t firstOfNode = block.curves.size();
  for (std::size_t i = 0; i < ids.size();) {
    const Id curve = segments[ids[i]].curve;
    double best = std::numeric_limits<double>::infinity(), arc = 0;
    Vec3 on = p, q;
    bool first = false, last = false;
    for (; i < ids.size() && segments[ids[i]].curve == curve; ++i) {
      const double s = table_.project(p, ids[i], q);
      const double d2 = (q - p).squaredNorm();
      if (d2 < best) best = d2, arc = s, on = q;
      first |= ids[i] == table_.firstSegment(curve);
      last |= ids[i] + 1 == table_.endSegment(curve);
    }
    const double d = std::sqrt(best) / scale;
    if (d <= options_.reach && reachable(row, on)) {
      block.curves.push_back({curve, {row, static_cast<float>(d + penalty(row)), arc}});
    }
    if (first) addCorner(graph_.curves()[curve].startCorner, row, block);
    if (last) addCorner(graph_.curves()[curve].endCorner, row, block);
  }
  preferNearest(block, firstOfNode);
}

void PathFinder::gather() {
  constexpr Id kBlock = 512;
  std::vector<Block> blocks((wall_.size() + kBlock - 1) / kBlock);
  tbb::parallel_for(std::size_t(0), blocks.size(), [&](std::size_t b) {
    const Id first = static_cast<Id>(b) * kBlock, last = std::min(wall_.size(), first + kBlock);
    for (Id row = first; row < last; ++row) gatherNode(row, blocks[b]);
  });
  std::vector<Id>& offsets = near_.curves.offsets;
  offsets.assign(graph_.curves().size() + 1, 0);
  for (const Block& block : blocks)
    for (const auto& pair : block.curves) ++offsets[pair.first + 1];
  for (std::size_t c = 1; c < offsets.size(); ++c) offsets[c] += offsets[c - 1];
  near_.curves.values.resize(offsets.back());
  std::vector<Id> next(offsets.begin(), offsets.end() - 1);
  for (const Block& block : blocks) {
    for (const auto& pair : block.curves) near_.curves.values[next[pair.first]++] = pair.second;
    near_.corners.insert(near_.corners.end(), block.corners.begin(), block.corners.end());
  }
  const auto order = [](const NearCorner& a, const NearCorner& b) {
    return std::tie(a.distance, a.corner, a.row) < std::tie(b.distance, b.corner, b.row);
  };
  const auto same = [](const NearCorner& a, const NearCorner& b) {
    return a.corner == b.corner && a.row == b.row;
  };
  std::sort(near_.corners.begin(), near_.corners.end(), order);
  near_.corners.erase(std::unique(near_.corners.begin(), near_.corners.end(), same), near_.corners.end());
}

/// The nearest corner that stands for itself within the merging distance, kNone when there is none.
Id PathFinder::findRepresentative(Id corner) const {
  const Vec3& at = graph_.corners()[corner];
  const double reach = options_.mergeCorners * cornerScale_[corner];
  Box box;
  box.add(at - Vec3::Constant(reach));
  box.add(at + Vec3::Constant(reach));
  Id best = kNone;
  double bestDistance = reach;
  for (Id s : graph_.segmentsNear(box)) {
    const FeatureCurve& curve = graph_.curves()[graph_.segments()[s].curve];
    for (Id c : {curve.startCorner, curve.endCorner}) {
      if (c == kNone || representative_[c] != c) continue;
      const double d = (graph_.corners()[c] - at).norm();
      if (d < bestDistance || (d == bestDistance && c < best)) best = c, bestDistance = d;
    }
  }
  return best;
}

/// Corners where most curves meet stand for the others around them.
void PathFinder::mergeCorners() {
  const std::size_t count = graph_.corners().size();
  cornerScale_.assign(count, 0.0);
  for (const NearCorner& n : near_.corners)
    if (cornerScale_[n.corner] == 0) cornerScale_[n.corner] = wall_.scale[n.row];
  std::vector<Id> valence(count, 0), order(count);
  for (const FeatureCurve& curve : graph_.curves())
    for (Id c : {curve.startCorner, curve.endCorner})
      if (c != kNone) ++valence[c];
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Id a, Id b) { return valence[a] > valence[b]; });
  representative_.assign(count, kNone);
  for (Id c : order) {
    const Id r = cornerScale_[c] > 0 ? findRepresentative(c) : kNone;
    representative_[c] = r == kNone ? c : r;
  }
}

/// Features between two zones are features of the walls of both.
void PathFinder::findZones() {
  zone_.assign(wall_.nodes.size(), 0);
  if (mesh_.zone.empty()) return;
  zones_ = static_cast<Id>(mesh_.zoneNames.size());
  for (Id row = 0; row < wall_.size(); ++row) zone_[row] = mesh_.zone[mesh_.owner[wall_.faces[row][0]]];
}

void PathFinder::placeCorners() {
  const Id corners = static_cast<Id>(graph_.corners().size());
  cornerRow_.assign(static_cast<std::size_t>(corners) * zones_, kNone);
  for (const NearCorner& n : near_.corners) {
    Id& row = cornerRow(n.corner, zone_[n.row]);
    if (representative_[n.corner] != n.corner || row != kNone || !isFree(n.row, kNone, n.corner)) continue;
    row = n.row;
    taken_[n.row] = {wall_.nodes[n.row], kNone, n.corner, graph_.corners()[n.corner]};
  }
  result_.cornerNode.assign(corners, kNone);
  for (Id zone = zones_; zone-- > 0;)
    for (Id c = 0; c < corners; ++c) {
      Id& row = cornerRow(c, zone);
      row = cornerRow(representative_[c], zone);
      if (row != kNone) result_.cornerNode[c] = wall_.nodes[row];
    }
}

double PathFinder::curveScale(Id curve) const {
  double sum = 0;
  for (const NearNode& n : near_.curves[curve]) sum += wall_.scale[n.row];
  return sum / static_cast<double>(near_.curves[curve].size());
}

/// A closed curve starts at the free node closest to it.
void PathFinder::chooseLoopStart(CurveTracer::Task& task) const {
  const double length = table_.length(task.curve);
  const auto best =
      std::min_element(task.nodes.begin(), task.nodes.end(), [](const NearNode& a, const NearNode& b) {
        return std::tie(a.distance, a.row) < std::tie(b.distance, b.row);
      });
  if (best == task.nodes.end()) return;
  task.startRow = task.endRow = best->row;
  task.startDistance = task.endDistance = best->distance;
  task.arcShift = best->arc;
  task.nodes.erase(best);
  for (NearNode& n : task.nodes) {
    n.arc -= task.arcShift;
    if (n.arc < 0) n.arc += length;
  }
}

CurveTracer::Task PathFinder::makeTask(Id curve, Id zone, double scale) const {
  const FeatureCurve& shape = graph_.curves()[curve];
  CurveTracer::Task task;
  task.curve = curve;
  task.scale = scale;
  for (const NearNode& n : near_.curves[curve])
    if (zone_[n.row] == zone && isFree(n.row, curve, kNone)) task.nodes.push_back(n);
  if (shape.closed) {
    chooseLoopStart(task);
    return task;
  }
  const auto distance = [&](Id row, Id corner) {
    return (mesh_.points[wall_.nodes[row]] - graph_.corners()[corner]).norm() / wall_.scale[row];
  };
  if (shape.startCorner != kNone) task.startRow = cornerRow(shape.startCorner, zone);
  if (shape.endCorner != kNone) task.endRow = cornerRow(shape.endCorner, zone);
  if (task.startRow != kNone) task.startDistance = distance(task.startRow, shape.startCorner);
  if (task.endRow != kNone) task.endDistance = distance(task.endRow, shape.endCorner);
  return task;
}

/// Arc lengths of a piece's nodes: their own, evened out, apart by a least spacing, between the ends. Nodes
/// that lie on the curve already stay where they are unless two nearly touch.
std::vector<double> PathFinder::spread(const std::vector<PathNode>& piece, double scale, bool firstFixed,
                                       bool lastFixed) const {
  const std::size_t n = piece.size();
  std::vector<double> s(n), next;
  for (std::size_t i = 0; i < n; ++i) s[i] = piece[i].arc;
  const double room = s[n - 1] - s[0];
  for (int sweep = 0; sweep < 2; ++sweep) {
    next = s;
    for (std::size_t i = 1; i + 1 < n; ++i)
      if (!piece[i].onCurve) next[i] = 0.5 * s[i] + 0.25 * (s[i - 1] + s[i + 1]);
    s = next;
  }
  const double wide =
      std::min(options_.spacing * scale, 0.6 * std::max(0.0, room) / static_cast<double>(n - 1));
  std::vector<double> place(n, 0.0);  // least arc length from the first node
  for (std::size_t i = 1; i < n; ++i)
    place[i] = place[i - 1] + (piece[i - 1].onCurve && piece[i].onCurve ? 0.3 * wide : wide);
  // Forward and backward sweeps both keep the spacing; so does their mean.
  std::vector<double> up = s, down = s;
  for (std::size_t i = 1; i < n; ++i) up[i] = std::max(s[i], up[i - 1] + place[i] - place[i - 1]);
  for (std::size_t i = n - 1; i-- > 0;) down[i] = std::min(s[i], down[i + 1] - (place[i + 1] - place[i]));
  for (std::size_t i = 0; i < n; ++i) s[i] = 0.5 * (up[i] + down[i]);
  const double lo = piece[0].arc, hi = piece[n - 1].arc;
  for (std::size_t i = 0; i < n; ++i) {
    if (firstFixed) s[i] = std::max(s[i], lo + place[i]);
    if (lastFixed) s[i] = std::min(s[i], hi - (place[n - 1] - place[i]));
  }
  return s;
}

void PathFinder::keepPiece(Id curve, const std::vector<PathNode>& piece, double shift, double scale) {
  const auto isEnd = [&](std::size_t i) { return taken_[piece[i].row].node != kNone; };
  const bool loop = piece.front().row == piece.back().row;
  const bool firstFixed = loop || isEnd(0), lastFixed = loop || isEnd(piece.size() - 1);
  const std::vector<double> arc = spread(piece, scale, firstFixed, lastFixed);
  std::vector<Id> nodes;
  for (std::size_t i = 0; i < piece.size(); ++i) {
    const Id row = piece[i].row;
    nodes.push_back(wall_.nodes[row]);
    if (piece[i].cut != kNone) {
      cut_[piece[i].cut - mesh_.internalFaces()] = 1;
      result_.cuts.push_back({piece[i].cut, nodes[i - 1], nodes[i]});
    }
    if (taken_[row].node == kNone)
      taken_[row] = {wall_.nodes[row], curve, kNone, table_.at(curve, arc[i] + shift)};
  }
  result_.pieces.push(nodes);
  result_.pieceCurve.push_back(curve);
}

void PathFinder::traceCurve(CurveTracer& tracer, Id curve) {
  if (near_.curves[curve].empty()) return;
  const double scale = curveScale(curve);
  std::vector<Id> zones;
  for (const NearNode& n : near_.curves[curve]) zones.push_back(zone_[n.row]);
  sortUnique(zones);
  CurveState& state = result_.curves[curve];
  for (Id zone : zones) state = std::max(state, traceInZone(tracer, curve, zone, scale));
}

CurveState PathFinder::traceInZone(CurveTracer& tracer, Id curve, Id zone, double scale) {
  const double length = table_.length(curve);
  CurveTracer::Task task = makeTask(curve, zone, scale);
  const bool loop = graph_.curves()[curve].closed || (task.startRow != kNone && task.startRow == task.endRow);
  if (length < (loop ? options_.shortestLoop : options_.shortest) * scale) return CurveState::Short;
  double traced = 0;
  std::size_t pieces = 0;
  for (const std::vector<PathNode>& piece : tracer.trace(task)) {
    if (piece.size() < 2) continue;
    keepPiece(curve, piece, task.arcShift, scale);
    traced += piece.back().arc - piece.front().arc;
    ++pieces;
  }
  if (pieces == 0) return CurveState::Unreached;
  return pieces == 1 && traced > length - scale ? CurveState::Traced : CurveState::Partial;
}

/// Paths cross a face once at most: ways across it might cross each other.
bool PathFinder::canCut(const WallCut& cut) const {
  return !cut_[cut.face - mesh_.internalFaces()] && options_.canCut(cut);
}

void PathFinder::collectTargets() {
  for (const NodeTarget& t : taken_)
    if (t.node != kNone) result_.targets.push_back(t);
}

FeaturePaths PathFinder::find() {
  taken_.resize(wall_.nodes.size());
  result_.curves.assign(graph_.curves().size(), CurveState::Unreached);
  gather();
  findZones();
  mergeCorners();
  placeCorners();
  std::vector<Id> order(graph_.curves().size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Id a, Id b) { return table_.length(a) > table_.length(b); });
  cut_.assign(mesh_.boundaryFaces(), 0);
  CanCut mayCut;
  if (options_.canCut) mayCut = [this](const WallCut& cut) { return canCut(cut); };
  CurveTracer tracer(mesh_, wall_, table_, mayCut);
  for (Id curve : order) traceCurve(tracer, curve);
  collectTargets();
  return std::move(result_);
}

}  // namespace

FeaturePaths traceFeatures(const PolyMesh& mesh, const WallSurface& wall, const FeatureGraph& graph,
                           const FeaturePathOptions& options, const PathHistory& history) {
  return PathFinder(mesh, wall, graph, options, history).find();
}

}  // namespace pm
