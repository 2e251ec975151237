// SPDX-License-Identifier: BSD-3-Clause
// Feature curves traced over the wall of a block of unit cubes.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "FeaturePaths.h"

namespace {

using namespace pm;

/// n^3 unit cubes whose whole boundary is wall. Only what tracing reads is filled: boundary faces.
PolyMesh blockWall(int n) {
  PolyMesh mesh;
  const auto id = [n](int i, int j, int k) { return static_cast<Id>((k * (n + 1) + j) * (n + 1) + i); };
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) mesh.points.emplace_back(i, j, k);
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side <= n; side += n)
      for (int v = 0; v < n; ++v)
        for (int u = 0; u < n; ++u) {
          std::vector<Id> row;
          for (const auto& [du, dv] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
            int c[3];
            c[axis] = side;
            c[(axis + 1) % 3] = u + du;
            c[(axis + 2) % 3] = v + dv;
            row.push_back(id(c[0], c[1], c[2]));
          }
          mesh.faces.push(row);
          mesh.owner.push_back(0);
          mesh.patch.push_back(0);
        }
  mesh.patchNames = {"block"};
  mesh.patchTypes = {"wall"};
  mesh.cellCount = n * n * n;
  return mesh;
}

struct Drawing {
  std::vector<Vec3> corners;
  std::vector<FeatureCurve> curves;

  Id corner(const Vec3& p) {
    const auto it = std::find(corners.begin(), corners.end(), p);
    if (it != corners.end()) return static_cast<Id>(it - corners.begin());
    corners.push_back(p);
    return static_cast<Id>(corners.size()) - 1;
  }
  void line(const Vec3& a, const Vec3& b, int parts = 7) {
    FeatureCurve curve;
    for (int i = 0; i <= parts; ++i) curve.points.push_back(a + (b - a) * (double(i) / parts));
    curve.startCorner = corner(a);
    curve.endCorner = corner(b);
    curves.push_back(curve);
  }
  void circle(const Vec3& centre, double radius, int parts = 40) {
    FeatureCurve curve;
    for (int i = 0; i < parts; ++i) {
      const double t = 2 * M_PI * i / parts;
      curve.points.push_back(centre + radius * Vec3(std::cos(t), std::sin(t), 0));
    }
    curve.closed = true;
    curves.push_back(curve);
  }
  FeatureGraph graph() const {
    std::vector<FeatureSegment> segments;
    for (std::size_t c = 0; c < curves.size(); ++c) {
      const auto& p = curves[c].points;
      for (std::size_t i = 0; i + 1 < p.size() + (curves[c].closed ? 1 : 0); ++i)
        segments.push_back({p[i], p[(i + 1) % p.size()], static_cast<Id>(c), kSharpEdge});
    }
    return FeatureGraph(corners, curves, segments);
  }
};

/// What holds for any result: targets on their features, one a node, path nodes joined by wall edges, arcs
/// ascending.
void expectSound(const PolyMesh& mesh, const WallSurface& wall, const FeatureGraph& graph,
                 const FeaturePaths& paths) {
  const CurveTable table(graph);
  std::vector<const NodeTarget*> of(mesh.points.size(), nullptr);
  for (std::size_t i = 0; i < paths.targets.size(); ++i) {
    const NodeTarget& t = paths.targets[i];
    if (i > 0) {
      EXPECT_LT(paths.targets[i - 1].node, t.node);
    }
    EXPECT_NE(t.curve == kNone, t.corner == kNone);
    of[t.node] = &t;
    if (t.curve != kNone)
      EXPECT_LT(graph.closestOnCurve(t.target, t.curve).distance2, 1e-20);
    else
      EXPECT_EQ(t.target, graph.corners()[t.corner]);
  }
  std::multiset<Id> inner;
  for (Id i = 0; i < paths.pieces.rows(); ++i) {
    const Span<Id> piece = paths.pieces[i];
    const Id curve = paths.pieceCurve[i];
    ASSERT_GE(piece.size(), 2u);
    double last = -1;
    for (std::size_t k = 0; k < piece.size(); ++k) {
      ASSERT_NE(of[piece[k]], nullptr);
      if (k > 0) {
        const Span<Id> around = wall.neighbours[wall.rowOf[piece[k - 1]]];
        EXPECT_TRUE(std::binary_search(around.begin(), around.end(), wall.rowOf[piece[k]]));
      }
      if (of[piece[k]]->corner != kNone) continue;
      EXPECT_EQ(of[piece[k]]->curve, curve);
      if (k > 0 || piece[0] != piece[piece.size() - 1]) inner.insert(piece[k]);
      if (graph.curves()[curve].closed) continue;
      Vec3 on;
      const double arc =
          table.project(of[piece[k]]->target, graph.closestOnCurve(of[piece[k]]->target, curve).segment, on);
      EXPECT_GT(arc, last);
      last = arc;
    }
  }
  for (Id p : inner) EXPECT_EQ(inner.count(p), 1u);
}

FeaturePaths trace(const PolyMesh& mesh, const FeatureGraph& graph) {
  const WallSurface wall = wallSurface(mesh);
  FeaturePaths paths = traceFeatures(mesh, wall, graph);
  expectSound(mesh, wall, graph, paths);
  return paths;
}

TEST(WallSurface, JoinsTheNodesOfABlock) {
  const PolyMesh mesh = blockWall(4);
  const WallSurface wall = wallSurface(mesh);
  EXPECT_EQ(wall.size(), 125 - 27);
  EXPECT_EQ(wall.rowOf[62], kNone);  // the middle of the block
  std::size_t edges = 0;
  for (Id row = 0; row < wall.size(); ++row) {
    edges += wall.neighbours[row].size();
    EXPECT_EQ(wall.rowOf[wall.nodes[row]], row);
    EXPECT_DOUBLE_EQ(wall.scale[row], 1.0);
    EXPECT_EQ(wall.neighbours[row].size(), wall.faces[row].size());
  }
  EXPECT_EQ(static_cast<int>(edges) / 2, wall.size() + 6 * 16 - 2);  // Euler
}

TEST(FeaturePaths, TakesTheEdgesOfACube) {
  const PolyMesh mesh = blockWall(6);
  Drawing d;
  for (int axis = 0; axis < 3; ++axis)
    for (int s = 0; s < 4; ++s) {
      Vec3 a = Vec3::Zero();
      a[(axis + 1) % 3] = s & 1 ? 6 : 0;
      a[(axis + 2) % 3] = s & 2 ? 6 : 0;
      Vec3 b = a;
      b[axis] = 6;
      d.line(a, b);
    }
  const FeatureGraph graph = d.graph();
  const FeaturePaths paths = trace(mesh, graph);
  for (CurveState state : paths.curves) EXPECT_EQ(state, CurveState::Traced);
  EXPECT_EQ(paths.targets.size(), 8u + 12u * 5u);
  for (const NodeTarget& t : paths.targets) EXPECT_LT((t.target - mesh.points[t.node]).norm(), 1e-12);
}

TEST(FeaturePaths, FollowsASlantedLine) {
  const PolyMesh mesh = blockWall(12);
  Drawing d;
  d.line(Vec3(1.2, 1.3, 12), Vec3(10.9, 8.1, 12));
  const FeatureGraph graph = d.graph();
  const FeaturePaths paths = trace(mesh, graph);
  ASSERT_EQ(paths.curves[0], CurveState::Traced);
  ASSERT_EQ(paths.pieces.rows(), 1);
  EXPECT_GE(paths.pieces[0].size(),
            12u);  // about one node for each unit of the line, at most a step each way
  EXPECT_LE(paths.pieces[0].size(), 18u);
  for (const NodeTarget& t : paths.targets) EXPECT_LT((t.target - mesh.points[t.node]).norm(), 0.9);
  EXPECT_EQ(mesh.points[paths.cornerNode[0]], Vec3(1, 1, 12));
  EXPECT_EQ(mesh.points[paths.cornerNode[1]], Vec3(11, 8, 12));
}

TEST(FeaturePaths, GoesRoundACircle) {
  const PolyMesh mesh = blockWall(12);
  Drawing d;
  d.circle(Vec3(6.1, 5.8, 12), 3.3);
  const FeatureGraph graph = d.graph();
  const FeaturePaths paths = trace(mesh, graph);
  ASSERT_EQ(paths.curves[0], CurveState::Traced);
  ASSERT_EQ(paths.pieces.rows(), 1);
  const Span<Id> piece = paths.pieces[0];
  EXPECT_EQ(piece[0], piece[piece.size() - 1]);
  EXPECT_GE(piece.size(), 20u);
  double turn = 0;  // once round the centre, not back and forth
  for (std::size_t k = 0; k + 1 < piece.size(); ++k) {
    const Vec3 a = mesh.points[piece[k]] - Vec3(6.1, 5.8, 12),
               b = mesh.points[piece[k + 1]] - Vec3(6.1, 5.8, 12);
    turn += std::atan2(a.x() * b.y() - a.y() * b.x(), a.x() * b.x() + a.y() * b.y());
  }
  EXPECT_NEAR(std::abs(turn), 2 * M_PI, 1e-9);
}

TEST(FeaturePaths, GivesCloseCurvesNodesOfTheirOwn) {
  const PolyMesh mesh = blockWall(12);
  Drawing d;
  d.line(Vec3(1, 5.3, 12), Vec3(11, 5.3, 12));
  d.line(Vec3(1, 5.95, 12), Vec3(11, 5.95, 12));
  const FeaturePaths paths = trace(mesh, d.graph());
  EXPECT_EQ(paths.curves[0], CurveState::Traced);
  EXPECT_EQ(paths.curves[1], CurveState::Traced);
}

TEST(FeaturePaths, LeavesAGapWhereAnotherCurveIsInTheWay) {
  const PolyMesh mesh = blockWall(12);
  Drawing d;
  d.line(Vec3(1, 6, 12), Vec3(11, 6, 12));
  d.line(Vec3(6, 2, 12), Vec3(6, 10, 12));  // crosses the longer one, without a corner there
  const FeatureGraph graph = d.graph();
  const FeaturePaths paths = trace(mesh, graph);
  EXPECT_EQ(paths.curves[0], CurveState::Traced);
  EXPECT_EQ(paths.curves[1], CurveState::Partial);
  EXPECT_EQ(paths.pieces.rows(), 3);
}

TEST(FeaturePaths, TracesThePartOfACurveThatIsOnTheWall) {
  const PolyMesh mesh = blockWall(8);
  Drawing d;
  d.line(Vec3(4, 4, 8), Vec3(20, 4, 8), 16);
  d.line(Vec3(50, 0, 0), Vec3(60, 0, 0));
  const FeaturePaths paths = trace(mesh, d.graph());
  EXPECT_EQ(paths.curves[0], CurveState::Partial);
  EXPECT_EQ(paths.curves[1], CurveState::Unreached);
  ASSERT_EQ(paths.pieces.rows(), 1);
  EXPECT_EQ(mesh.points[paths.pieces[0][0]], Vec3(4, 4, 8));
  EXPECT_EQ(mesh.points[paths.pieces[0][paths.pieces[0].size() - 1]].x(), 8);
}

TEST(FeaturePaths, SkipsWhatTheMeshCannotShow) {
  const PolyMesh mesh = blockWall(8);
  Drawing d;
  d.circle(Vec3(4, 4, 8), 0.3);
  d.line(Vec3(1, 1, 8), Vec3(1.3, 1, 8));
  const FeaturePaths paths = trace(mesh, d.graph());
  EXPECT_EQ(paths.curves[0], CurveState::Short);
  EXPECT_EQ(paths.curves[1], CurveState::Short);
  EXPECT_EQ(paths.cornerNode[0], paths.cornerNode[1]);  // one corner for the mesh
  EXPECT_EQ(paths.targets.size(), 1u);
}

TEST(FeaturePaths, KeepsNodesOnTheirDomainSide) {
  PolyMesh mesh = blockWall(8);
  mesh.fixed.assign(mesh.points.size(), 0);
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
    if (mesh.points[p].x() == 8) mesh.fixed[p] = 1;
  Drawing d;
  d.line(Vec3(2, 4.2, 8), Vec3(7.6, 4.2, 8));  // ends beside the side x = 8
  const FeaturePaths paths = trace(mesh, d.graph());
  for (const NodeTarget& t : paths.targets)
    if (mesh.fixed[t.node]) {
      EXPECT_NEAR(t.target.x(), 8, 0.05);
    }
}

// ------------------------------------------------------------------------------------- paths across faces

void expectSame(const FeaturePaths& a, const FeaturePaths& b) {
  ASSERT_EQ(a.targets.size(), b.targets.size());
  for (std::size_t i = 0; i < a.targets.size(); ++i) {
    EXPECT_EQ(a.targets[i].node, b.targets[i].node);
    EXPECT_EQ(a.targets[i].target, b.targets[i].target);
  }
  ASSERT_EQ(a.cuts.size(), b.cuts.size());
  for (std::size_t i = 0; i < a.cuts.size(); ++i) {
    EXPECT_EQ(a.cuts[i].face, b.cuts[i].face);
    EXPECT_EQ(a.cuts[i].a, b.cuts[i].a);
    EXPECT_EQ(a.cuts[i].b, b.cuts[i].b);
  }
}

FeaturePathOptions cutting(std::function<bool(const WallCut&)> canCut = [](const WallCut&) { return true; }) {
  FeaturePathOptions options;
  options.canCut = std::move(canCut);
  return options;
}

/// The paths with cuts, and the mesh with these made; expects what holds for any of them.
struct CutPaths {
  PolyMesh mesh;
  FeaturePaths paths;
};
CutPaths traceAcross(const PolyMesh& mesh, const FeatureGraph& graph, const FeaturePathOptions& options) {
  CutPaths r{mesh, traceFeatures(mesh, wallSurface(mesh), graph, options)};
  std::set<Id> faces;
  for (const WallCut& cut : r.paths.cuts) {
    EXPECT_TRUE(faces.insert(cut.face).second) << "two cuts of face " << cut.face;
    const Span<Id> row = mesh.faces[cut.face];
    const auto at = [&](Id p) { return std::find(row.begin(), row.end(), p) - row.begin(); };
    EXPECT_LT(std::max(at(cut.a), at(cut.b)), 4);
    EXPECT_EQ(std::abs(at(cut.a) - at(cut.b)), 2);
  }
  cutWallFaces(r.mesh, r.paths.cuts);
  expectSound(r.mesh, wallSurface(r.mesh), graph, r.paths);
  return r;
}

Drawing diagonal(int n) {
  Drawing d;
  d.line(Vec3(1, 1, n), Vec3(n - 1, n - 1, n));
  return d;
}

TEST(FeaturePaths, GoAcrossFacesAlongADiagonal) {
  const PolyMesh mesh = blockWall(12);
  const FeatureGraph graph = diagonal(12).graph();
  const FeaturePaths stairs = trace(mesh, graph);
  EXPECT_TRUE(stairs.cuts.empty());
  ASSERT_EQ(stairs.pieces.rows(), 1);
  EXPECT_GT(stairs.pieces[0].size(), 18u);
  const FeaturePaths across = traceAcross(mesh, graph, cutting()).paths;
  EXPECT_EQ(across.curves[0], CurveState::Traced);
  ASSERT_EQ(across.pieces.rows(), 1);
  EXPECT_EQ(across.pieces[0].size(), 11u);
  EXPECT_EQ(across.cuts.size(), 10u);
  for (const NodeTarget& t : across.targets) EXPECT_LT((t.target - mesh.points[t.node]).norm(), 1e-12);
}

TEST(FeaturePaths, CutOnlyWhatTheyMay) {
  const PolyMesh mesh = blockWall(12);
  Drawing d;
  d.line(Vec3(1.2, 1.3, 12), Vec3(10.9, 8.1, 12));
  d.circle(Vec3(6.1, 5.8, 0), 3.3);
  const FeatureGraph graph = d.graph();
  const FeaturePaths plain = trace(mesh, graph);
  int asked = 0;
  const FeaturePaths refused = traceAcross(mesh, graph, cutting([&](const WallCut&) {
                                             ++asked;
                                             return false;
                                           }))
                                   .paths;
  EXPECT_GT(asked, 20);
  EXPECT_TRUE(refused.cuts.empty());
  expectSame(refused, plain);
  EXPECT_EQ(refused.pieces.values, plain.pieces.values);
  const auto even = [](const WallCut& cut) { return cut.face % 2 == 0; };
  const FeaturePaths some = traceAcross(mesh, graph, cutting(even)).paths;
  EXPECT_FALSE(some.cuts.empty());
  for (const WallCut& cut : some.cuts) EXPECT_TRUE(even(cut));
  for (CurveState state : some.curves) EXPECT_EQ(state, CurveState::Traced);
}

TEST(FeaturePaths, AreNoLongerAndNoFartherWithCuts) {
  const PolyMesh mesh = blockWall(12);
  for (int i = 0; i < 12; ++i) {
    const double turn = 0.5 * M_PI * i / 12;
    Drawing d;
    const Vec3 way(std::cos(turn), std::sin(turn), 0), middle(6.2, 5.9, 12);
    d.line(middle - 4.5 * way, middle + 4.5 * way);
    const FeatureGraph graph = d.graph();
    const auto nodesAndMiss = [&](const FeaturePaths& paths) {
      double miss = 0;
      for (const NodeTarget& t : paths.targets) miss += (t.target - mesh.points[t.node]).squaredNorm();
      return std::pair(paths.targets.size(), miss);
    };
    const auto [nodes, miss] = nodesAndMiss(trace(mesh, graph));
    const auto [nodesAcross, missAcross] = nodesAndMiss(traceAcross(mesh, graph, cutting()).paths);
    EXPECT_LE(nodesAcross, nodes) << "line " << i;
    EXPECT_LE(missAcross, miss + 0.3) << "line " << i;
  }
}

TEST(FeaturePaths, OfTwoCurvesOneCrossesAFace) {
  const PolyMesh mesh = blockWall(12);
  Drawing d = diagonal(12);
  d.line(Vec3(1, 10, 12), Vec3(10, 1, 12));  // crosses the other in the middle of a face
  const FeaturePaths paths = traceAcross(mesh, d.graph(), cutting()).paths;
  EXPECT_EQ(paths.curves[0], CurveState::Traced);
  EXPECT_GE(paths.cuts.size(), 15u);
}

TEST(FeaturePaths, NoFaceLiesOnAPathAsAWhole) {
  // A curve that turns back within a face would take all its points.
  const PolyMesh mesh = blockWall(12);
  for (int i = 0; i < 20; ++i) {
    Drawing d;
    d.circle(Vec3(6 + 0.05 * i, 6 - 0.03 * i, 12), 0.6 + 0.1 * i);
    const CutPaths r = traceAcross(mesh, d.graph(), cutting());
    std::vector<char> onPath(mesh.points.size(), 0);
    for (Id piece = 0; piece < r.paths.pieces.rows(); ++piece) {
      const Span<Id> row = r.paths.pieces[piece];
      if (row.size() < 6) continue;
      for (std::size_t k = 0; k + 3 < row.size(); ++k) {
        const std::set<Id> run(row.begin() + k, row.begin() + k + 4);
        for (Id f = 0; f < r.mesh.faceCount(); ++f)
          EXPECT_FALSE(std::all_of(r.mesh.faces[f].begin(), r.mesh.faces[f].end(),
                                   [&](Id p) { return run.count(p) > 0; }))
              << "circle " << i << ", face " << f;
      }
    }
  }
}

TEST(FeaturePaths, SameForAnyNumberOfThreads) {
  const PolyMesh mesh = blockWall(24);
  Drawing d;
  for (int i = 0; i < 12; ++i) d.line(Vec3(1.5, 1 + 1.7 * i, 24), Vec3(21.5, 2 + 1.63 * i, 24), 11);
  d.circle(Vec3(12, 12, 0), 7.7);
  const FeatureGraph graph = d.graph();
  FeaturePaths first, firstAcross;
  for (int threads : {1, 2, 4}) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const FeaturePaths paths = trace(mesh, graph), across = traceAcross(mesh, graph, cutting()).paths;
    if (threads == 1) first = paths, firstAcross = across;
    expectSame(first, paths);
    expectSame(firstAcross, across);
  }
  EXPECT_GT(first.targets.size(), 200u);
  EXPECT_GT(firstAcross.cuts.size(), 10u);
}

}  // namespace
