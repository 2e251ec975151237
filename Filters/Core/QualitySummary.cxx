// SPDX-License-Identifier: BSD-3-Clause
// Measures against limits: the summary and the sentences about what is violated.
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <string>
#include <vector>

#include "MeshQuality.h"

namespace pm {
namespace {

constexpr double kClosed = 1e-6;  // openness is stored as float; anything topological is far larger

double volumeUnit(const PolyMesh& mesh) {
  return mesh.finestSize > 0 ? mesh.finestSize * mesh.finestSize * mesh.finestSize : 1.0;
}

/// Sum of volumes in fixed blocks: the same bits for any number of threads.
double totalVolume(const std::vector<CellMeasures>& cells) {
  constexpr std::size_t kBlock = 4096;
  std::vector<double> sums((cells.size() + kBlock - 1) / kBlock, 0.0);
  tbb::parallel_for(std::size_t(0), sums.size(), [&](std::size_t i) {
    const std::size_t last = std::min(cells.size(), (i + 1) * kBlock);
    for (std::size_t c = i * kBlock; c < last; ++c) sums[i] += cells[c].volume;
  });
  double total = 0;
  for (double sum : sums) total += sum;
  return total;
}

/// One limit, how many faces or cells break it, and the worst of them.
struct Criterion {
  const char* what;   // "internal faces"
  const char* value;  // "angle"
  bool upper;         // the limit is the largest allowed value
  double limit;
  Id first, last;  // rows it applies to
  Id outside = 0, worst = kNone;
  double worstValue = 0;

  bool holds(double v) const { return withinLimit(v, limit, upper); }
  bool worse(double v) const {
    if (worst == kNone) return true;
    return !std::isnan(worstValue) && !(upper ? v <= worstValue : v >= worstValue);
  }
  double severity() const {
    if (upper) return worstValue / limit;
    return worstValue > 0 ? limit / worstValue : std::numeric_limits<double>::infinity();
  }
};

template <class Value>
void scan(Criterion& criterion, std::vector<std::uint8_t>& outside, const Value& value) {
  for (Id i = criterion.first; i < criterion.last; ++i) {
    const double v = value(i);
    if (criterion.worse(v)) {
      criterion.worst = i;
      criterion.worstValue = v;
    }
    if (criterion.holds(v)) continue;
    ++criterion.outside;
    outside[i] = 1;
  }
}

enum { kVolume, kTet, kPyramid, kOpen, kEtaIn, kEtaOut, kAngleIn, kAngleOut, kWarp, kSkewIn, kSkewOut };

struct Scan {
  std::vector<Criterion> criteria;
  Id violations = 0;
};

Scan scanAll(const PolyMesh& mesh, const MeshMeasures& m, const QualityLimits& limits) {
  const Id faces = mesh.faceCount(), internal = mesh.internalFaces(), cells = mesh.cellCount;
  const double unit = volumeUnit(mesh);
  Scan s;
  s.criteria = {{"cells", "volume in finest cells", false, limits.minVolume, 0, cells},
                {"cells", "smallest central tetrahedron in finest cells", false, limits.minTet, 0, cells},
                {"cells", "smallest face pyramid in finest cells", false, limits.minTet, 0, cells},
                {"cells", "openness", true, kClosed, 0, cells},
                {"internal faces", "degradation", false, limits.minEtaInternal, 0, internal},
                {"boundary faces", "degradation", false, limits.minEtaBoundary, internal, faces},
                {"internal faces", "angle in degrees", true, limits.maxAngleInternal, 0, internal},
                {"boundary faces", "angle in degrees", true, limits.maxAngleBoundary, internal, faces},
                {"faces", "warpage in degrees", true, limits.maxWarpage, 0, faces},
                {"internal faces", "skewness", true, limits.maxSkewInternal, 0, internal},
                {"boundary faces", "skewness", true, limits.maxSkewBoundary, internal, faces}};
  std::vector<std::uint8_t> badCell(cells, 0), badFace(faces, 0);
  scan(s.criteria[kVolume], badCell, [&](Id c) { return m.cells[c].volume / unit; });
  scan(s.criteria[kTet], badCell, [&](Id c) { return m.cells[c].minTet / unit; });
  scan(s.criteria[kPyramid], badCell, [&](Id c) { return m.cells[c].minPyramid / unit; });
  scan(s.criteria[kOpen], badCell, [&](Id c) { return m.openness[c]; });
  for (int i : {kEtaIn, kEtaOut}) scan(s.criteria[i], badFace, [&](Id f) { return m.faces[f].eta; });
  for (int i : {kAngleIn, kAngleOut}) scan(s.criteria[i], badFace, [&](Id f) { return m.faceAngle[f]; });
  scan(s.criteria[kWarp], badFace, [&](Id f) { return m.faces[f].warpage(); });
  for (int i : {kSkewIn, kSkewOut}) scan(s.criteria[i], badFace, [&](Id f) { return m.faceSkew[f]; });
  for (std::uint8_t bad : badCell) s.violations += bad;
  for (std::uint8_t bad : badFace) s.violations += bad;
  return s;
}

}  // namespace

QualitySummary summarise(const PolyMesh& mesh, const MeshMeasures& measures, const QualityLimits& limits) {
  const Scan s = scanAll(mesh, measures, limits);
  QualitySummary q;
  const auto take = [&](double& into, int criterion) {
    if (s.criteria[criterion].worst != kNone) into = s.criteria[criterion].worstValue;
  };
  take(q.minVolume, kVolume);
  take(q.minTet, kTet);
  take(q.minPyramid, kPyramid);
  take(q.maxOpenness, kOpen);
  take(q.minEtaInternal, kEtaIn);
  take(q.minEtaBoundary, kEtaOut);
  take(q.maxAngleInternal, kAngleIn);
  take(q.maxAngleBoundary, kAngleOut);
  take(q.maxWarpage, kWarp);
  take(q.maxSkewInternal, kSkewIn);
  take(q.maxSkewBoundary, kSkewOut);
  q.totalVolume = totalVolume(measures.cells);
  q.violations = s.violations;
  return q;
}

std::string describeViolations(const PolyMesh& mesh, const MeshMeasures& measures,
                               const QualityLimits& limits) {
  std::vector<Criterion> broken;
  for (const Criterion& c : scanAll(mesh, measures, limits).criteria) {
    if (c.outside > 0) broken.push_back(c);
  }
  std::stable_sort(broken.begin(), broken.end(),
                   [](const Criterion& a, const Criterion& b) { return a.severity() > b.severity(); });
  std::string text;
  for (const Criterion& c : broken) {
    text += fmt::format("{} of {} {} are outside a limit: {} {} {:.6g}; the worst is {:.6g} at id {}.\n",
                        c.outside, c.last - c.first, c.what, c.value, c.upper ? "above" : "below", c.limit,
                        c.worstValue, c.worst);
  }
  return text;
}

}  // namespace pm
