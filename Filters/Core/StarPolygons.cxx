// SPDX-License-Identifier: BSD-3-Clause
#include "StarPolygons.h"

#include <algorithm>

namespace pm {
namespace {

constexpr double kEven = 0.02;

/// Smallest triangle about the mean of the corners, over their mean area: 1 when all are alike.
double evenness(const std::vector<Vec2>& points, Span<Id> row) {
  Vec2 centre = Vec2::Zero();
  for (Id p : row) centre += points[p] / static_cast<double>(row.size());
  double least = std::numeric_limits<double>::infinity(), sum = 0;
  Vec2 a = points[row[row.size() - 1]] - centre;
  for (Id p : row) {
    const Vec2 b = points[p] - centre;
    const double area = a[0] * b[1] - a[1] * b[0];
    least = std::min(least, area);
    sum += std::abs(area);
    a = b;
  }
  return sum > 0 ? least * static_cast<double>(row.size()) / sum : 0;
}

double evenness(const std::vector<Vec2>& points, const std::vector<Id>& row) {
  return evenness(points, Span<Id>{row.data(), row.data() + row.size()});
}

/// Twice the area of a triangle, above 0 when it runs counter-clockwise.
double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0];
}

double areaOf(const std::vector<Vec2>& points, const std::vector<Id>& row) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < row.size(); ++i)
    twice += turn(points[row[0]], points[row[i]], points[row[i + 1]]);
  return twice / 2;
}

/// Whether the line between corners i and j meets no edge but at its ends.
bool isClear(const std::vector<Vec2>& points, const std::vector<Id>& row, std::size_t i, std::size_t j) {
  const Vec2 &a = points[row[i]], &b = points[row[j]];
  for (std::size_t k = 0; k < row.size(); ++k) {
    const std::size_t next = (k + 1) % row.size();
    if (k == i || k == j || next == i || next == j) continue;
    const Vec2 &c = points[row[k]], &d = points[row[next]];
    if (turn(a, b, c) * turn(a, b, d) <= 0 && turn(c, d, a) * turn(c, d, b) <= 0) return false;
  }
  return true;
}

}  // namespace

bool isStar(const std::vector<Vec2>& points, Span<Id> row) { return evenness(points, row) > kEven; }

std::vector<std::vector<Id>> cutIntoStars(const std::vector<Vec2>& points, Span<Id> row) {
  std::vector<std::vector<Id>> parts;
  std::vector<Id> rest(row.begin(), row.end());
  while (!(evenness(points, rest) > kEven)) {
    // The diagonal that leaves the best two parts, else the best one part.
    double bestBoth = 0, bestOne = 0;
    std::vector<Id> part, other;
    const std::size_t n = rest.size();
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t count = 3; count < n; ++count) {  // corners of the part that begins at i
        if (!isClear(points, rest, i, (i + count - 1) % n)) continue;
        std::vector<Id> turned = rest;
        std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(i), turned.end());
        std::vector<Id> first(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(count));
        std::vector<Id> second(turned.begin() + static_cast<std::ptrdiff_t>(count) - 1, turned.end());
        second.push_back(turned[0]);
        if (!(areaOf(points, second) > 0)) continue;
        const double one = evenness(points, first), both = std::min(one, evenness(points, second));
        if (both > bestBoth || (bestBoth == 0 && one > bestOne)) {
          part = std::move(first);
          other = std::move(second);
          bestBoth = std::max(both, 0.0);
          bestOne = one;
        }
      }
    }
    if (part.empty()) return {};
    parts.push_back(std::move(part));
    rest = std::move(other);
  }
  parts.push_back(std::move(rest));
  return parts;
}

}  // namespace pm
