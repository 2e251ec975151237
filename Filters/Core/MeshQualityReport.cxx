// SPDX-License-Identifier: BSD-3-Clause
#include "MeshQualityReport.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pm {
namespace {

constexpr double kClosed = 1e-6;
constexpr double kDecades = 1e3;  // a histogram over more than this is one of ratios

double volumeUnit(const PolyMesh& mesh) {
  return mesh.finestSize > 0 ? mesh.finestSize * mesh.finestSize * mesh.finestSize : 1.0;
}

/// Adds measures to a report, with their means and what is outside.
class Lister {
 public:
  Lister(const PolyMesh& mesh, MeshQualityReport& report) : mesh_(mesh), report_(report) {}

  template <class Value>
  void cells(const char* name, bool upper, double limit, const Value& value) {
    add(name, true, upper, limit, 0, mesh_.cellCount, value);
  }
  template <class Value>
  void faces(const char* name, bool upper, double limit, const Value& value) {
    add(name, false, upper, limit, 0, mesh_.faceCount(), value);
  }
  template <class Value>
  void internal(const std::string& name, bool upper, double limit, const Value& value) {
    add(name, false, upper, limit, 0, mesh_.internalFaces(), value);
  }
  template <class Value>
  void boundary(const std::string& name, bool upper, double limit, const Value& value) {
    add(name, false, upper, limit, mesh_.internalFaces(), mesh_.faceCount(), value);
  }
  QualityMeasure& last() { return report_.measures.back(); }

 private:
  template <class Value>
  void add(const std::string& name, bool ofCells, bool upper, double limit, Id first, Id last,
           const Value& value) {
    QualityMeasure m;
    m.name = name;
    m.ofCells = ofCells;
    m.upper = upper;
    m.limit = limit;
    m.first = first;
    m.values.reserve(last - first);
    for (Id i = first; i < last; ++i) {
      m.values.push_back(value(i));
      m.outside += !m.holds(m.values.back());
    }
    const double sum = std::accumulate(m.values.begin(), m.values.end(), 0.0);
    m.mean = m.values.empty() ? 0 : sum / static_cast<double>(m.values.size());
    report_.measures.push_back(std::move(m));
  }

  const PolyMesh& mesh_;
  MeshQualityReport& report_;
};

void listThesis(Lister& list, const PolyMesh& mesh, const MeshMeasures& m, const QualityLimits& limits) {
  const double unit = volumeUnit(mesh);
  list.cells("Volume", false, limits.minVolume, [&](Id c) { return m.cells[c].volume / unit; });
  list.cells("CentralTet", false, limits.minTet, [&](Id c) { return m.cells[c].minTet / unit; });
  list.cells("FacePyramid", false, limits.minTet, [&](Id c) { return m.cells[c].minPyramid / unit; });
  list.cells("Openness", true, kClosed, [&](Id c) { return m.openness[c]; });
  const auto eta = [&](Id f) { return m.faces[f].eta; };
  const auto angle = [&](Id f) { return m.faceAngle[f]; };
  list.internal("EtaInternal", false, limits.minEtaInternal, eta);
  list.boundary("EtaBoundary", false, limits.minEtaBoundary, eta);
  list.internal("AngleInternal", true, limits.maxAngleInternal, angle);
  list.boundary("AngleBoundary", true, limits.maxAngleBoundary, angle);
  list.faces("Warpage", true, limits.maxWarpage, [&](Id f) { return m.faces[f].warpage(); });
}

void listFoam(Lister& list, const MeshMeasures& m, const FoamMeasures& foam, const QualityLimits& limits,
              const FoamLimits& extra) {
  const auto of = [](const std::vector<double>& values) { return [&values](Id i) { return values[i]; }; };
  list.internal("SkewInternal", true, limits.maxSkewInternal, of(foam.skewness));
  list.boundary("SkewBoundary", true, limits.maxSkewBoundary, of(foam.skewness));
  list.internal("NonOrthogonality", true, extra.maxNonOrthogonality, of(foam.nonOrthogonality));
  list.last().mean = foam.meanNonOrthogonality;
  list.internal("FaceWeight", false, limits.minFaceWeight, of(foam.weight));
  list.internal("VolumeRatio", false, limits.minVolumeRatio, of(foam.volumeRatio));
  list.faces("FaceArea", false, 0, [&](Id f) { return m.faces[f].normal.norm(); });
  list.faces("Flatness", false, extra.minFlatness, of(foam.flatness));
  list.last().mean = foam.meanFlatness;
  list.faces("FaceConcavity", true, extra.maxFaceConcavity, of(foam.concavity));
  list.faces("FaceTet", false, extra.minFaceTet, of(foam.tet));
  list.cells("AspectRatio", true, extra.maxAspectRatio, [&](Id c) { return foam.cells[c].aspectRatio; });
  list.cells("Determinant", false, limits.minDeterminant, [&](Id c) { return foam.cells[c].determinant; });
  list.cells("CellConcavity", true, extra.maxCellConcavity, [&](Id c) { return foam.cells[c].concavity; });
}

QualityPlace placeOf(const PolyMesh& mesh, const MeshMeasures& m, const QualityMeasure& measure, Id row) {
  QualityPlace place;
  place.value = measure.values[row];
  const Id id = measure.first + row;
  if (measure.ofCells) {
    place.cell = id;
    place.position = m.cells[id].centre;
    return place;
  }
  place.face = id;
  place.cell = mesh.owner[id];
  place.position = m.faces[id].centre;
  if (id < mesh.internalFaces()) {
    place.neighbour = mesh.neighbour[id];
  } else {
    place.patch = mesh.patch[id - mesh.internalFaces()];
  }
  return place;
}

void addWorst(const PolyMesh& mesh, const MeshMeasures& m, Id index, Id wanted, MeshQualityReport& report) {
  const QualityMeasure& measure = report.measures[index];
  std::vector<Id> order(measure.values.size());
  std::iota(order.begin(), order.end(), 0);
  const auto last = order.begin() + std::min<std::ptrdiff_t>(wanted, order.end() - order.begin());
  std::partial_sort(order.begin(), last, order.end(), [&](Id a, Id b) {
    const double x = measure.values[a], y = measure.values[b];
    if (measure.worse(x, y)) return true;
    return !measure.worse(y, x) && a < b;
  });
  for (auto row = order.begin(); row != last; ++row) {
    report.places.push_back(placeOf(mesh, m, measure, *row));
    report.places.back().measure = index;
  }
}

}  // namespace

bool QualityMeasure::holds(double value) const { return withinLimit(value, limit, upper); }

bool QualityMeasure::worse(double a, double b) const {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) && !std::isnan(b);
  return upper ? a > b : a < b;
}

const QualityMeasure& MeshQualityReport::measure(const std::string& name) const {
  for (const QualityMeasure& m : measures) {
    if (m.name == name) return m;
  }
  throw InternalError("There is no measure " + name + ".");
}

QualityHistogram histogram(const std::vector<double>& values, Id bins) {
  QualityHistogram h;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (double v : values) {
    if (!std::isfinite(v)) continue;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  h.counts.assign(bins, 0);
  if (!(low <= high)) low = high = 0;
  const bool ratios = low > 0 && high > kDecades * low;
  const auto scale = [&](double v) { return ratios ? std::log(v) : v; };
  const double from = scale(low), width = (scale(high) - from) / bins;
  for (Id i = 0; i <= bins; ++i) h.edges.push_back(ratios ? std::exp(from + i * width) : from + i * width);
  h.edges.front() = low;
  h.edges.back() = high;
  for (double v : values) {
    if (!std::isfinite(v)) continue;
    const double at = width > 0 ? (scale(v) - from) / width : 0;
    ++h.counts[std::clamp(static_cast<Id>(at), Id(0), bins - 1)];
  }
  return h;
}

MeshQualityReport reportMeshQuality(const PolyMesh& mesh, const MeshQualityReportOptions& options,
                                    Monitor& monitor) {
  QualityLimits limits = options.limits;
  if (mesh.stage == Stage::Refined || mesh.stage == Stage::None)
    limits.minVolume = limits.minEtaInternal = limits.minEtaBoundary = 0;
  MeshQualityReport report;
  monitor.check(0.1, "measuring");
  const MeshMeasures measures = measure(mesh);
  const FoamMeasures foam = measureFoam(mesh, measures, options.solved, monitor);
  monitor.check(0.7, "listing measures");
  Lister list(mesh, report);
  listThesis(list, mesh, measures, limits);
  listFoam(list, measures, foam, limits, options.foam);
  report.concaveCells = foam.concaveCells;
  for (Id i = 0; i < static_cast<Id>(report.measures.size()); ++i) {
    monitor.check(0.8, "finding the worst places");
    addWorst(mesh, measures, i, options.worstPlaces, report);
    report.histograms.push_back(histogram(report.measures[i].values, options.bins));
  }
  return report;
}

std::vector<float> worstOfCells(const PolyMesh& mesh, const QualityMeasure& measure) {
  if (measure.ofCells) return {measure.values.begin(), measure.values.end()};
  std::vector<float> worst(mesh.cellCount, std::numeric_limits<float>::quiet_NaN());
  std::vector<std::uint8_t> seen(mesh.cellCount, 0);
  for (std::size_t i = 0; i < measure.values.size(); ++i) {
    const Id f = measure.first + static_cast<Id>(i);
    const auto take = [&](Id cell) {
      if (!seen[cell] || measure.worse(measure.values[i], worst[cell]))
        worst[cell] = static_cast<float>(measure.values[i]);
      seen[cell] = 1;
    };
    take(mesh.owner[f]);
    if (f < mesh.internalFaces()) take(mesh.neighbour[f]);
  }
  return worst;
}

std::vector<Id> facesOutside(const MeshQualityReport& report) {
  std::vector<Id> faces;
  for (const QualityMeasure& m : report.measures) {
    if (m.ofCells || m.outside == 0) continue;
    for (std::size_t i = 0; i < m.values.size(); ++i) {
      if (!m.holds(m.values[i])) faces.push_back(m.first + static_cast<Id>(i));
    }
  }
  sortUnique(faces);
  return faces;
}

}  // namespace pm
