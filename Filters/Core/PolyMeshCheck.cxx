// SPDX-License-Identifier: BSD-3-Clause
// The invariants of PolyMesh as one predicate, and its checksum.
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cstring>
#include <numeric>

#include "PolyMesh.h"

namespace pm {
namespace {

/// Smallest i in [0, count) for which `broken(i, scratch)` holds, kNone when none does; a scratch for each
/// block.
template <class Scratch, class Broken>
Id firstBroken(Id count, const Broken& broken) {
  const Id found = tbb::parallel_reduce(
      tbb::blocked_range<Id>(0, count, 4096), count,
      [&](const tbb::blocked_range<Id>& range, Id best) {
        Scratch scratch;
        for (Id i = range.begin(); i != range.end() && i < best; ++i) {
          if (broken(i, scratch)) return i;
        }
        return best;
      },
      [](Id a, Id b) { return std::min(a, b); });
  return found == count ? kNone : found;
}

/// A directed edge, the smaller point first.
struct Edge {
  Id a, b;
  bool forward;
  bool operator<(const Edge& e) const {
    return a != e.a ? a < e.a : b != e.b ? b < e.b : forward < e.forward;
  }
};

template <class Body>
void forEachEdge(Span<Id> row, const Body& body) {
  Id p = row[row.size() - 1];
  for (Id q : row) {
    body(p, q);
    p = q;
  }
}

void addEdges(Span<Id> row, bool flip, std::vector<Edge>& edges) {
  forEachEdge(row, [&](Id p, Id q) { edges.push_back({std::min(p, q), std::max(p, q), (p < q) != flip}); });
}

/// True when each edge occurs exactly twice, once in each direction.
bool closesUp(std::vector<Edge>& edges) {
  std::sort(edges.begin(), edges.end());
  if (edges.empty() || edges.size() % 2 != 0) return false;
  for (std::size_t i = 0; i < edges.size(); i += 2) {
    const Edge &x = edges[i], &y = edges[i + 1];
    if (x.a != y.a || x.b != y.b || x.forward == y.forward) return false;
    if (i > 0 && edges[i - 1].a == x.a && edges[i - 1].b == x.b) return false;
  }
  return true;
}

std::string checkLengths(const PolyMesh& mesh) {
  const std::size_t faces = mesh.faceCount(), cells = mesh.cellCount, points = mesh.points.size();
  const auto differs = [](const char* name, std::size_t has, std::size_t needs) {
    return has == needs ? std::string()
                        : fmt::format("Array {} has {} values instead of {}.", name, has, needs);
  };
  if (mesh.cellCount < 0) return "The number of cells is negative.";
  if (mesh.neighbour.size() > faces) return "There are more neighbours than faces.";
  const std::string messages[] = {differs("owner", mesh.owner.size(), faces),
                                  differs("patch", mesh.patch.size(), faces - mesh.neighbour.size()),
                                  differs("patchTypes", mesh.patchTypes.size(), mesh.patchNames.size()),
                                  differs("level", mesh.level.size(), cells),
                                  differs("layer", mesh.layer.size(), cells),
                                  differs("zone", mesh.zone.size(), mesh.zoneNames.empty() ? 0 : cells),
                                  differs("fixed", mesh.fixed.size(), points),
                                  differs("base", mesh.base.size(), points)};
  for (const std::string& message : messages) {
    if (!message.empty()) return message;
  }
  return {};
}

std::string checkRanges(const PolyMesh& mesh) {
  const Id points = static_cast<Id>(mesh.points.size()), internal = mesh.internalFaces();
  const Id patches = static_cast<Id>(mesh.patchNames.size());
  const auto outside = [](Id id, Id count) { return id < 0 || id >= count; };
  const std::vector<Id>& offsets = mesh.faces.offsets;
  if (offsets.front() != 0 || !std::is_sorted(offsets.begin(), offsets.end()) ||
      static_cast<std::size_t>(offsets.back()) != mesh.faces.values.size()) {
    return "The rows of the faces do not fit their values.";
  }
  for (Id f = 0; f < mesh.faceCount(); ++f) {
    const Span<Id> row = mesh.faces[f];
    if (row.size() < 3) return fmt::format("Face {} has only {} points.", f, row.size());
    for (Id p : row) {
      if (outside(p, points)) return fmt::format("Face {} names point {}, which does not exist.", f, p);
      if (std::count(row.begin(), row.end(), p) > 1)
        return fmt::format("Face {} names point {} twice.", f, p);
    }
    if (outside(mesh.owner[f], mesh.cellCount)) {
      return fmt::format("The owner of face {} is cell {}, which does not exist.", f, mesh.owner[f]);
    }
    if (f < internal && outside(mesh.neighbour[f], mesh.cellCount)) {
      return fmt::format("The neighbour of face {} is cell {}, which does not exist.", f, mesh.neighbour[f]);
    }
    if (f < internal && mesh.owner[f] >= mesh.neighbour[f]) {
      return fmt::format("The owner of face {} is cell {}, not smaller than its neighbour {}.", f,
                         mesh.owner[f], mesh.neighbour[f]);
    }
    if (f >= internal && outside(mesh.patch[f - internal], patches)) {
      return fmt::format("Face {} is in patch {}, which does not exist.", f, mesh.patch[f - internal]);
    }
  }
  const Id zones = static_cast<Id>(mesh.zoneNames.size());
  for (std::size_t c = 0; c < mesh.zone.size(); ++c)
    if (outside(mesh.zone[c], zones))
      return fmt::format("Cell {} is in zone {}, which does not exist.", c, mesh.zone[c]);
  for (Id f = 0; f < internal && !mesh.zone.empty(); ++f)
    if (mesh.zone[mesh.owner[f]] != mesh.zone[mesh.neighbour[f]])
      return fmt::format("Face {} joins cells of two zones.", f);
  return {};
}

std::string checkPoints(const PolyMesh& mesh) {
  const Id points = static_cast<Id>(mesh.points.size());
  std::vector<char> used(points, 0);
  for (Id p : mesh.faces.values) used[p] = 1;
  for (Id p = 0; p < points; ++p) {
    if (!used[p]) return fmt::format("Point {} is in no face.", p);
    if (!mesh.points[p].allFinite()) return fmt::format("Point {} has a coordinate that is not finite.", p);
    if (mesh.base[p] < kNone || mesh.base[p] >= points || mesh.base[p] == p) {
      return fmt::format("The base of point {} is {}, which is no other point.", p, mesh.base[p]);
    }
  }
  return {};
}

std::string checkCells(const PolyMesh& mesh) {
  const Csr<Id> facesOfCell = cellFaces(mesh);
  const Id c = firstBroken<std::vector<Edge>>(mesh.cellCount, [&](Id cell, std::vector<Edge>& edges) {
    edges.clear();
    for (Id f : facesOfCell[cell]) addEdges(mesh.faces[f], mesh.owner[f] != cell, edges);
    return !closesUp(edges);
  });
  if (c == kNone) return {};
  return fmt::format(
      "Cell {} is not closed: an edge is not in exactly two of its faces in opposite directions.", c);
}

/// Edges of boundary faces in rows by their smaller point.
std::string checkBoundary(const PolyMesh& mesh) {
  const Id internal = mesh.internalFaces(), faces = mesh.faceCount();
  std::vector<Id> start(mesh.points.size() + 1, 0);
  const auto forEachBoundaryEdge = [&](const auto& body) {
    for (Id f = internal; f < faces; ++f) forEachEdge(mesh.faces[f], body);
  };
  forEachBoundaryEdge([&](Id p, Id q) { ++start[std::min(p, q) + 1]; });
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<Edge> edges(start.back());
  std::vector<Id> next(start.begin(), start.end() - 1);
  forEachBoundaryEdge([&](Id p, Id q) {
    edges[next[std::min(p, q)]++] = {std::min(p, q), std::max(p, q), p < q};
  });
  const Id count = static_cast<Id>(mesh.points.size());
  const Id p = firstBroken<std::vector<Edge>>(count, [&](Id point, std::vector<Edge>& own) {
    own.assign(edges.begin() + start[point], edges.begin() + start[point + 1]);
    return !own.empty() && !closesUp(own);
  });
  if (p == kNone) return {};
  return fmt::format(
      "The boundary is not manifold: an edge at point {} is not in exactly two boundary faces.", p);
}

constexpr std::uint64_t kPrime = 0x9E3779B97F4A7C15ull;

std::uint64_t mix(std::uint64_t hash, std::uint64_t word) {
  hash = (hash ^ word) * kPrime;
  return hash ^ (hash >> 29);
}

std::uint64_t hashBlock(const unsigned char* bytes, std::size_t count) {
  std::uint64_t hash = mix(kPrime, count);
  for (; count >= 8; bytes += 8, count -= 8) {
    std::uint64_t word;
    std::memcpy(&word, bytes, 8);
    hash = mix(hash, word);
  }
  std::uint64_t rest = 0;
  std::memcpy(&rest, bytes, count);
  return mix(hash, rest);
}

/// Blocks of fixed size, so that the sum does not depend on the number of threads.
std::uint64_t hashBytes(std::uint64_t hash, const void* data, std::size_t count) {
  constexpr std::size_t kBlock = 1 << 16;
  const auto* bytes = static_cast<const unsigned char*>(data);
  std::vector<std::uint64_t> sums((count + kBlock - 1) / kBlock);
  tbb::parallel_for(std::size_t(0), sums.size(), [&](std::size_t i) {
    sums[i] = hashBlock(bytes + i * kBlock, std::min(kBlock, count - i * kBlock));
  });
  hash = mix(hash, count);
  for (std::uint64_t sum : sums) hash = mix(hash, sum);
  return hash;
}

template <class T>
std::uint64_t hashArray(std::uint64_t hash, const std::vector<T>& values) {
  return hashBytes(hash, values.data(), values.size() * sizeof(T));
}

}  // namespace

std::string checkTopology(const PolyMesh& mesh) {
  using Check = std::string (*)(const PolyMesh&);
  for (const Check check : {Check(checkLengths), Check(checkRanges), Check(checkPoints), Check(checkCells),
                            Check(checkBoundary)}) {
    std::string message = check(mesh);
    if (!message.empty()) return message;
  }
  return {};
}

std::uint64_t checksum(const PolyMesh& mesh) {
  std::uint64_t hash = kPrime;
  hash = hashArray(hash, mesh.points);
  hash = hashArray(hash, mesh.faces.offsets);
  hash = hashArray(hash, mesh.faces.values);
  hash = hashArray(hash, mesh.owner);
  hash = hashArray(hash, mesh.neighbour);
  hash = hashArray(hash, mesh.patch);
  for (const auto* names : {&mesh.patchNames, &mesh.patchTypes}) {
    for (const std::string& name : *names) hash = hashBytes(hash, name.data(), name.size());
  }
  hash = hashArray(hash, mesh.level);
  hash = hashArray(hash, mesh.layer);
  hash = hashArray(hash, mesh.fixed);
  hash = hashArray(hash, mesh.base);
  if (!mesh.zoneNames.empty()) {
    hash = hashArray(hash, mesh.zone);
    for (const std::string& name : mesh.zoneNames) hash = hashBytes(hash, name.data(), name.size());
  }
  hash = hashBytes(hash, &mesh.finestSize, sizeof mesh.finestSize);
  hash = mix(hash, static_cast<std::uint64_t>(mesh.cellCount));
  return mix(hash, static_cast<std::uint64_t>(mesh.stage));
}

}  // namespace pm
