// SPDX-License-Identifier: BSD-3-Clause
#include "FarField.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "SideColumns.h"

namespace pm {
namespace {

constexpr std::array<const char*, 6> kSideNames{"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
constexpr int axisOf(int side) { return side / 2; }
constexpr bool isUpper(int side) { return side % 2 != 0; }

/// Distances within one step differ by no more than this; the corner cells' angle is atan(1.6 sqrt(2)) = 66
/// degrees.
constexpr double kMostUnlike = 1.6;

/// The meshed box, and which of its sides are extended.
struct Domain {
  Box box;
  std::array<Id, 6> patch;  // kNone = the mesh has no face there
  std::array<bool, 6> extend;

  double plane(int side) const { return isUpper(side) ? box.hi[axisOf(side)] : box.lo[axisOf(side)]; }
  bool stays(int axis) const { return !extend[2 * axis] && !extend[2 * axis + 1]; }
};

template <class Body>
void forEachSideFace(const PolyMesh& mesh, Id patch, const Body& body) {
  for (Id b = 0; b < mesh.boundaryFaces(); ++b)
    if (mesh.patch[b] == patch) body(mesh.internalFaces() + b);
}

[[noreturn]] void refuseNoSide(int side, bool any) {
  if (!any)
    throw InputError(
        "The mesh has no domain sides to extend; mesh the outside of the geometry in a given domain (Use "
        "Domain "
        "of Octree Decompose) first.");
  throw InputError(fmt::format(
      "The mesh has no faces on the domain side {}; do not extend it, or mesh the side of the geometry that "
      "reaches it.",
      kSideNames[side]));
}

/// A side whose name a patch of the geometry has is named with "_domain" behind it.
bool isNameOf(const std::string& patch, int side) {
  const std::string name = kSideNames[side], mark = "_domain";
  if (patch.compare(0, name.size(), name) != 0) return false;
  for (std::size_t i = name.size(); i < patch.size(); i += mark.size())
    if (patch.compare(i, mark.size(), mark) != 0) return false;
  return true;
}

Domain findDomain(const PolyMesh& mesh, const std::array<bool, 6>& extend) {
  Domain domain;
  domain.extend = extend;
  bool any = false;
  for (int s = 0; s < 6; ++s) {
    domain.patch[s] = kNone;
    for (std::size_t i = 0; i < mesh.patchNames.size(); ++i)
      if (mesh.patchTypes[i] == "patch" && isNameOf(mesh.patchNames[i], s)) domain.patch[s] = Id(i);
    any |= domain.patch[s] != kNone;
  }
  for (const Vec3& p : mesh.points) domain.box.add(p);
  for (int s = 0; s < 6; ++s) {
    bool found = false;
    double& plane = isUpper(s) ? domain.box.hi[axisOf(s)] : domain.box.lo[axisOf(s)];
    forEachSideFace(mesh, domain.patch[s], [&](Id f) {
      for (Id p : mesh.faces[f]) {
        const double x = mesh.points[p][axisOf(s)];
        if (found && x != plane)
          throw InputError(
              fmt::format("The domain side {} is not a plane; make the mesh again.", kSideNames[s]));
        plane = x;
        found = true;
      }
    });
    if (extend[s] && !found) refuseNoSide(s, any);
  }
  return domain;
}

/// How fractions of the way out grow from layer to layer: a geometric progression.
struct Progression {
  int layers = 1;
  double ratio = 1;

  double at(int k) const {
    if (k >= layers) return 1;
    return ratio > 1 ? std::expm1(k * std::log(ratio)) / std::expm1(layers * std::log(ratio))
                     : double(k) / layers;
  }
};

/// The fewest layers whose first is `first` of the way and that grow by at most `mostRatio`.
Progression progressionFrom(double first, double mostRatio, int mostLayers) {
  Progression p;
  first = std::min(first, 1.0);
  const double growth = mostRatio - 1;
  const double wanted = growth > 1e-6 ? std::log1p(growth / first) / std::log(mostRatio) : 1 / first;
  p.layers = static_cast<int>(std::clamp(std::ceil(wanted - 1e-9), 1.0, double(mostLayers)));
  double low = 1, high = mostRatio;
  for (int i = 0; i < 60; ++i) {  // the ratio with which so many layers begin as thin
    p.ratio = 0.5 * (low + high);
    (p.at(1) > first ? low : high) = p.ratio;
  }
  p.ratio = high;
  return p;
}

/// Where the columns' nodes go: rays from the domain's sides to the far boundary.
class Similarity {
 public:
  /// far: the box that the sides are moved to. radius > 0: the rays end on that sphere about `centre`.
  Similarity(const Domain& domain, const Box& far, double radius, const Vec3& centre)
      : domain_(domain), far_(far), radius_(radius), centre_(centre) {
    width_ = std::numeric_limits<double>::infinity();
    const Vec3 size = domain.box.size();
    for (int a = 0; a < 3; ++a) {
      const bool both = domain.extend[2 * a] && domain.extend[2 * a + 1];
      if (!domain.stays(a)) width_ = std::min(width_, both ? 0.5 * size[a] : size[a]);
    }
  }

  Vec3 place(const Vec3& x, double fraction) const {
    if (!(radius_ > 0)) return boxPlace(x, fraction);
    const Vec3 end = onSphere(x);
    return fraction < 1 ? Vec3(x + fraction * (end - x)) : end;
  }

 private:
  /// From -1 on the extended lower side to 1 on the upper one; 0 in the core.
  double lean(const Vec3& x, int axis) const {
    const auto depth = [&](int side) {  // 1 on the side, 0 where the core begins
      if (!domain_.extend[side]) return 0.0;
      return std::max(0.0, 1 - std::abs(domain_.plane(side) - x[axis]) / width_);
    };
    return depth(2 * axis + 1) - depth(2 * axis);
  }

  Vec3 boxPlace(const Vec3& x, double fraction) const {
    Vec3 p = x;
    for (int a = 0; a < 3; ++a) {
      const double w = lean(x, a);
      if (w == 0) continue;
      const double whole = w > 0 ? far_.hi[a] - domain_.box.hi[a] : domain_.box.lo[a] - far_.lo[a];
      p[a] += fraction * w * whole;
      if (fraction == 1 && std::abs(w) == 1) p[a] = w > 0 ? far_.hi[a] : far_.lo[a];
    }
    return p;
  }

  Vec3 onSphere(const Vec3& x) const {
    Vec3 out = boxPlace(x, 1) - centre_;
    for (int a = 0; a < 3; ++a)
      if (domain_.stays(a)) out[a] = 0;
    Vec3 p = centre_ + radius_ / out.norm() * out;
    for (int a = 0; a < 3; ++a)
      if (domain_.stays(a)) p[a] = x[a];
    return p;
  }

  const Domain& domain_;
  Box far_;
  double radius_;
  Vec3 centre_;
  double width_;  // of the fanning part of a side: the smallest half width
};

/// Median over a side's area of how thick the cells at it are: volume over area of the face.
double thicknessAt(const PolyMesh& mesh, const std::vector<double>& volume, Id patch) {
  std::vector<std::pair<double, double>> found;
  double whole = 0;
  forEachSideFace(mesh, patch, [&](Id f) {
    const double area = measureFace(mesh.points, mesh.faces[f], true).normal.norm();
    found.emplace_back(volume[mesh.owner[f]] / area, area);
    whole += area;
  });
  std::sort(found.begin(), found.end());
  double sum = 0;
  for (const auto& [thickness, area] : found)
    if ((sum += area) >= 0.5 * whole) return thickness;
  return found.back().first;
}

/// Volumes of the cells at the extended sides, 0 for the others.
std::vector<double> volumesAtSides(const PolyMesh& mesh, const Domain& domain) {
  std::vector<char> wanted(mesh.cellCount, 0);
  for (int s = 0; s < 6; ++s)
    if (domain.extend[s]) forEachSideFace(mesh, domain.patch[s], [&](Id f) { wanted[mesh.owner[f]] = 1; });
  std::vector<double> volume(mesh.cellCount, 0.0);
  const Vec3 origin = domain.box.centre();
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    const Id own = mesh.owner[f], other = f < mesh.internalFaces() ? mesh.neighbour[f] : own;
    if (!wanted[own] && !wanted[other]) continue;
    const FaceMeasures face = measureFace(mesh.points, mesh.faces[f], true);
    const double third = face.normal.dot(face.centre - origin) / 3;
    volume[own] += third;
    if (other != own) volume[other] -= third;
  }
  return volume;
}

/// Layers that begin no thicker than the cells at any side; longest[s]: the way from side s to the far
/// boundary.
Progression chooseLayers(const PolyMesh& mesh, const Domain& domain, const std::array<double, 6>& longest,
                         const FarFieldOptions& options) {
  const std::vector<double> volume = volumesAtSides(mesh, domain);
  double first = 1;
  for (int s = 0; s < 6; ++s)
    if (domain.extend[s]) first = std::min(first, thicknessAt(mesh, volume, domain.patch[s]) / longest[s]);
  return progressionFrom(first, options.expansionRatio, options.maxLayers);
}

PolyMesh grow(const PolyMesh& mesh, const Domain& domain, const Similarity& map, const Progression& layers,
              bool ontoSphere) {
  SideColumns columns;
  columns.layers = layers.layers;
  columns.extend.assign(mesh.patchNames.size(), false);
  for (int s = 0; s < 6; ++s)
    if (domain.extend[s]) columns.extend[domain.patch[s]] = true;
  columns.outerPatch = ontoSphere ? "far" : "";
  columns.place = [&](const Vec3& x, int k) { return map.place(x, layers.at(k)); };
  columns.fixed = [&](const Vec3& x, bool outermost) {
    std::uint8_t bits = outermost && ontoSphere ? 7 : 0;
    for (int s = 0; s < 6; ++s)
      if ((outermost || !domain.extend[s]) && x[axisOf(s)] == domain.plane(s)) bits |= 1 << axisOf(s);
    return bits;
  };
  return growColumns(mesh, columns);
}

/// What of the remaining distances one step bridges: all of those that are alike, as much of the others.
std::array<double, 6> stepOf(const std::array<double, 6>& remaining) {
  double least = std::numeric_limits<double>::infinity();
  for (double d : remaining)
    if (d > 0) least = std::min(least, d);
  std::array<double, 6> step = remaining;
  for (double& d : step)
    if (d > kMostUnlike * least) d = least;
  return step;
}

double chosenDistance(const Domain& domain, const FarFieldOptions& options) {
  return options.distance > 0 ? options.distance : 2 * domain.box.size().maxCoeff();
}

std::array<double, 6> boxDistances(const Domain& domain, const FarFieldOptions& options) {
  std::array<double, 6> distance{};
  const double tolerance = 1e-9 * domain.box.diagonal();
  for (int s = 0; s < 6; ++s) {
    if (!domain.extend[s]) continue;
    const double far = isUpper(s) ? options.bounds.hi[axisOf(s)] : options.bounds.lo[axisOf(s)];
    distance[s] = !options.useBounds ? chosenDistance(domain, options)
                  : isUpper(s)       ? far - domain.plane(s)
                                     : domain.plane(s) - far;
    if (!(distance[s] > tolerance) || !std::isfinite(distance[s]))
      throw InputError(fmt::format(
          "The far boundary's {} of {:g} is not outside the domain, which ends at {:g}; move it out, "
          "or do not extend this side.",
          kSideNames[s], far, domain.plane(s)));
  }
  return distance;
}

PolyMesh growToBox(PolyMesh mesh, Domain domain, const FarFieldOptions& options, Monitor& monitor,
                   FarFieldReport& report) {
  std::array<double, 6> remaining = boxDistances(domain, options);
  const Vec3 lo = options.bounds.lo, hi = options.bounds.hi;
  while (std::any_of(remaining.begin(), remaining.end(), [](double d) { return d > 0; })) {
    monitor.check(0.1, "far columns");
    const std::array<double, 6> step = stepOf(remaining);
    Box far = domain.box;
    for (int s = 0; s < 6; ++s) {
      const bool last = step[s] == remaining[s];
      double& plane = isUpper(s) ? far.hi[axisOf(s)] : far.lo[axisOf(s)];
      if (domain.extend[s]) plane += isUpper(s) ? step[s] : -step[s];
      if (domain.extend[s] && last && options.useBounds) plane = isUpper(s) ? hi[axisOf(s)] : lo[axisOf(s)];
      remaining[s] = last ? 0 : remaining[s] - step[s];
    }
    const Progression layers = chooseLayers(mesh, domain, step, options);
    mesh = grow(mesh, domain, Similarity(domain, far, 0, Vec3::Zero()), layers, false);
    ++report.steps;
    report.layers += layers.layers;
    report.growth = std::max(report.growth, layers.ratio);
    for (int s = 0; s < 6; ++s) domain.extend[s] = remaining[s] > 0;
    domain = findDomain(mesh, domain.extend);
  }
  return mesh;
}

/// Centre of a sphere, and its distance to the farthest corner of the domain that it must enclose.
struct Enclosure {
  Vec3 centre;
  Vec3 reach;  // from the centre to the farthest sides; 0 along a cylinder's axis
};

Enclosure enclose(const Domain& domain) {
  Enclosure e{domain.box.centre(), 0.5 * domain.box.size()};
  for (int a = 0; a < 3; ++a) {
    const bool lower = domain.extend[2 * a], upper = domain.extend[2 * a + 1];
    if (lower == upper) {
      if (!lower) e.reach[a] = 0;
      continue;
    }
    e.centre[a] = lower ? domain.box.hi[a] : domain.box.lo[a];
    e.reach[a] = domain.box.size()[a];
  }
  return e;
}

PolyMesh growToSphere(const PolyMesh& mesh, const Domain& domain, const FarFieldOptions& options,
                      Monitor& monitor, FarFieldReport& report) {
  const Enclosure e = enclose(domain);
  const double corner = e.reach.norm();
  const double radius = options.radius > 0 ? options.radius : corner + chosenDistance(domain, options);
  if (!(radius > corner * (1 + 1e-9)) || !std::isfinite(radius))
    throw InputError(fmt::format(
        "The far sphere's radius {:g} does not reach around the domain, whose farthest corner is {:g} "
        "from the centre ({:g}, {:g}, {:g}); use a larger radius.",
        radius, corner, e.centre[0], e.centre[1], e.centre[2]));
  monitor.check(0.1, "far columns");
  const double beyond = radius - e.reach.maxCoeff();
  Box far = domain.box;
  std::array<double, 6> longest{};
  for (int s = 0; s < 6; ++s) {
    if (!domain.extend[s]) continue;
    (isUpper(s) ? far.hi[axisOf(s)] : far.lo[axisOf(s)]) += isUpper(s) ? beyond : -beyond;
    longest[s] = radius - e.reach[axisOf(s)];
  }
  const Progression layers = chooseLayers(mesh, domain, longest, options);
  report.steps = 1;
  report.layers = layers.layers;
  report.growth = layers.ratio;
  return grow(mesh, domain, Similarity(domain, far, radius, e.centre), layers, true);
}

/// Measures of far cells and their faces alone: those of the inner mesh are made harmless.
MeshMeasures measureFar(const PolyMesh& mesh, Id firstCell) {
  MeshMeasures m = measure(mesh);
  CellMeasures fine;
  fine.volume = fine.minTet = fine.minPyramid = std::numeric_limits<double>::max();
  std::fill_n(m.cells.begin(), firstCell, fine);
  std::fill_n(m.openness.begin(), firstCell, 0.0f);
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    if (mesh.owner[f] >= firstCell || (f < mesh.internalFaces() && mesh.neighbour[f] >= firstCell)) continue;
    m.faces[f].eta = 1;
    m.faces[f].cosWarpage = 1;
    m.faceAngle[f] = m.faceSkew[f] = 0;
  }
  return m;
}

void checkFar(const PolyMesh& mesh, Id firstCell, const FarFieldOptions& options, FarFieldReport& report) {
  const MeshMeasures m = measureFar(mesh, firstCell);
  QualityLimits limits = options.limits;
  // As for boundary layers: cells that stretch along their column are meant.
  if (mesh.stage == Stage::Refined) limits.minVolume = limits.minEtaInternal = limits.minEtaBoundary = 0;
  std::string found = describeViolations(mesh, m, limits);
  if (!found.empty()) {
    found.erase(found.find('\n'));
    throw InputError(
        "The far cells would not be valid: " + found +
        (options.shape == FarShape::Box
             ? " Choose distances to the far boundary that are more alike, or a smaller expansion ratio."
             : " Choose a larger radius, a domain whose edges are more alike, or a far box."));
  }
  report.cells = mesh.cellCount - firstCell;
  report.volume = 0;
  for (Id c = firstCell; c < mesh.cellCount; ++c) report.volume += m.cells[c].volume;
  report.maxAngle = *std::max_element(m.faceAngle.begin(), m.faceAngle.begin() + mesh.internalFaces());
}

void checkOptions(const FarFieldOptions& o) {
  if (std::none_of(o.extend.begin(), o.extend.end(), [](bool e) { return e; }))
    throw InputError("No side is to be extended; choose at least one of the domain's sides.");
  if (!(o.expansionRatio >= 1) || o.expansionRatio > 10)
    throw InputError(
        fmt::format("The expansion ratio must be between 1 and 10, not {:g}.", o.expansionRatio));
  if (o.maxLayers < 1)
    throw InputError(fmt::format("At least one layer of far cells is needed, not {}.", o.maxLayers));
  if (!(o.distance >= 0) || !(o.radius >= 0) || !std::isfinite(o.distance) || !std::isfinite(o.radius))
    throw InputError(
        "The distance and the radius of the far boundary must be lengths, or 0 to have them chosen.");
}

}  // namespace

PolyMesh farField(const PolyMesh& mesh, const FarFieldOptions& options, Monitor& monitor,
                  FarFieldReport* report) {
  checkOptions(options);
  monitor.check(0, "domain sides");
  FarFieldReport local;
  FarFieldReport& r = report ? *report : local;
  r = FarFieldReport();
  const Domain domain = findDomain(mesh, options.extend);
  PolyMesh out = options.shape == FarShape::Box ? growToBox(mesh, domain, options, monitor, r)
                                                : growToSphere(mesh, domain, options, monitor, r);
  monitor.check(0.6, "measuring far cells");
  checkFar(out, mesh.cellCount, options, r);
  return out;
}

}  // namespace pm
