// SPDX-License-Identifier: BSD-3-Clause
#include "StlWriter.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cctype>
#include <numeric>

#include "OutputFile.h"

namespace pm {
namespace {

constexpr const char* kCaption = "writing the STL file";

void putTriangle(TextBuffer& out, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a).stableNormalized();  // zero where the triangle has no area
  fmt::format_to(std::back_inserter(out), " facet normal {:.6g} {:.6g} {:.6g}\n  outer loop\n", normal.x(),
                 normal.y(), normal.z());
  for (const Vec3* p : {&a, &b, &c}) {
    fmt::format_to(std::back_inserter(out), "   vertex {} {} {}\n", p->x(), p->y(), p->z());
  }
  out.append(fmt::string_view("  endloop\n endfacet\n"));
}

/// Whether both triangles of the quad along the diagonal from corner 0 to 2 look the same way.
bool splits(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot((c - a).cross(d - a)) > 0;
}

void putPolygon(TextBuffer& out, const std::vector<Vec3>& points, Span<Id> row) {
  const auto corner = [&](std::size_t i) -> const Vec3& { return points[row[i % row.size()]]; };
  if (row.size() == 3) return putTriangle(out, corner(0), corner(1), corner(2));
  if (row.size() == 4) {
    // Exactly flat, as the sides of a domain are: a diagonal then changes nothing.
    const bool flat = (corner(1) - corner(0)).cross(corner(2) - corner(0)).dot(corner(3) - corner(0)) == 0;
    for (std::size_t i = 0; i < 2 && flat; ++i) {
      if (!splits(corner(i), corner(i + 1), corner(i + 2), corner(i + 3))) continue;
      putTriangle(out, corner(i), corner(i + 1), corner(i + 2));
      return putTriangle(out, corner(i), corner(i + 2), corner(i + 3));
    }
  }
  Vec3 centre = Vec3::Zero();
  for (Id p : row) centre += points[p];
  centre /= static_cast<double>(row.size());
  for (std::size_t i = 0; i < row.size(); ++i) putTriangle(out, centre, corner(i), corner(i + 1));
}

/// A name as one line.
std::string lineOf(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
  return name;
}

}  // namespace

void writeStl(const PolygonSurface& surface, const std::string& path, Monitor& monitor) {
  const Id polygons = surface.polygons.rows();
  if (polygons == 0) throw InputError("The surface has no polygons; there is nothing to write.");
  std::vector<Id> order(polygons);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Id a, Id b) { return surface.patch[a] < surface.patch[b]; });

  OutputFile file(path);
  for (Id first = 0, last = 0; first < polygons; first = last) {
    const Id patch = surface.patch[order[first]];
    while (last < polygons && surface.patch[order[last]] == patch) ++last;
    const std::string name = lineOf(surface.patchNames[patch]);
    PartMonitor part(monitor, static_cast<double>(first) / polygons, static_cast<double>(last) / polygons);
    file.text("solid " + name + "\n");
    writeItems(file, last - first, part, kCaption, [&](Id i, TextBuffer& out) {
      putPolygon(out, surface.points, surface.polygons[order[first + i]]);
    });
    file.text("endsolid " + name + "\n");
  }
  monitor.check(1, kCaption);
  file.close();
  file.publish();
}

}  // namespace pm
