// SPDX-License-Identifier: BSD-3-Clause
#include "DistanceField.h"

#include <fmt/format.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

namespace pm {

namespace {

using LeafKey = std::uint64_t;
constexpr LeafKey kOutside = std::numeric_limits<LeafKey>::max();
constexpr int kAxisBits = 21;                     // of a voxel's place; 3 bits of them within its leaf
constexpr double kCentre = 1 << (kAxisBits - 1);  // keeps places positive
constexpr const char* kTriangles = "closest_triangle";
constexpr const char* kDistances = "distance";
constexpr const char* kHash = "geometry_hash";
constexpr const char* kVoxelSize = "voxel_size";

/// Leaf-major number of a voxel: voxels of one OpenVDB leaf (8^3) are neighbours in ascending order.
LeafKey keyOf(const openvdb::Coord& c) {
  LeafKey leaf = 0, inner = 0;
  for (int axis = 0; axis < 3; ++axis) {
    leaf = leaf << (kAxisBits - 3) | static_cast<LeafKey>(c[axis] >> 3);
    inner = inner << 3 | static_cast<LeafKey>(c[axis] & 7);
  }
  return leaf << 9 | inner;
}

openvdb::Coord coordOf(LeafKey key) {
  openvdb::Coord c;
  for (int axis = 2, shift = 0; axis >= 0; --axis, ++shift) {
    const LeafKey inner = key >> (3 * shift) & 7;
    const LeafKey leaf = key >> (9 + (kAxisBits - 3) * shift) & ((1 << (kAxisBits - 3)) - 1);
    c[axis] = static_cast<openvdb::Int32>(leaf << 3 | inner);
  }
  return c;
}

}  // namespace

struct DistanceField::Grids {
  openvdb::Int32Grid::Ptr triangles = openvdb::Int32Grid::create(kNone);
  openvdb::FloatGrid::Ptr distances = openvdb::FloatGrid::create(std::numeric_limits<float>::max());
  Vec3 origin;
  double size;

  /// False for points too far away to be worth a voxel.
  bool locate(const Vec3& p, openvdb::Coord& c) const {
    const Vec3 place = (p - origin) / size;
    if (!(place.cwiseAbs().maxCoeff() < kCentre - 1)) return false;
    for (int axis = 0; axis < 3; ++axis)
      c[axis] = static_cast<openvdb::Int32>(std::floor(place[axis]) + kCentre);
    return true;
  }
  Vec3 centre(const openvdb::Coord& c) const {
    return origin + size * Vec3(c[0] + 0.5 - kCentre, c[1] + 0.5 - kCentre, c[2] + 0.5 - kCentre);
  }
};

DistanceField::DistanceField(const SurfaceModel& model, double voxelSize, bool enabled) : model_(model) {
  if (!(voxelSize > 0) || !std::isfinite(voxelSize))
    throw InputError(
        fmt::format("The voxel size of the distance field is {}; it must be a length above 0.", voxelSize));
  if (!enabled) return;
  grids_ = std::make_unique<Grids>();
  grids_->origin = model.bounds().centre();
  grids_->size = voxelSize;
}

DistanceField::~DistanceField() = default;

void DistanceField::fill(const std::vector<Vec3>& points) {
  if (!grids_) return;
  std::vector<LeafKey> keys(points.size());
  tbb::parallel_for(std::size_t(0), points.size(), [&](std::size_t i) {
    openvdb::Coord c;
    keys[i] = grids_->locate(points[i], c) ? keyOf(c) : kOutside;
  });
  tbb::parallel_sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  if (!keys.empty() && keys.back() == kOutside) keys.pop_back();

  // The tree grows here, in one thread; below each leaf is written by one task alone.
  struct Run {
    std::size_t begin, end;
    openvdb::Int32Tree::LeafNodeType* triangles;
    openvdb::FloatTree::LeafNodeType* distances;
  };
  std::vector<Run> runs;
  for (std::size_t begin = 0, end; begin < keys.size(); begin = end) {
    for (end = begin; end < keys.size() && keys[end] >> 9 == keys[begin] >> 9;) ++end;
    const openvdb::Coord c = coordOf(keys[begin]);
    runs.push_back(
        {begin, end, grids_->triangles->tree().touchLeaf(c), grids_->distances->tree().touchLeaf(c)});
  }
  tbb::parallel_for(std::size_t(0), runs.size(), [&](std::size_t r) {
    const Run& run = runs[r];
    Closest last;
    for (std::size_t i = run.begin; i < run.end; ++i) {
      const openvdb::Coord c = coordOf(keys[i]);
      if (run.triangles->isValueOn(c)) continue;
      last = model_.closest(grids_->centre(c), last);
      if (last.triangle == kNone) continue;
      run.triangles->setValueOn(c, last.triangle);
      run.distances->setValueOn(c, static_cast<float>(std::sqrt(last.distance2)));
    }
  });
}

Closest DistanceField::closest(const Vec3& p) const {
  openvdb::Coord c;
  if (!grids_ || !grids_->locate(p, c)) return model_.closest(p);
  constexpr double kRounding = 1 + 1e-6;
  const double known = grids_->distances->tree().getValue(c);
  const Closest found = model_.closestWithin(p, kRounding * (known + (p - grids_->centre(c)).norm()));
  return found.triangle != kNone ? found : model_.closest(p);  // far from the origin, rounding may count more
}

std::size_t DistanceField::activeVoxels() const { return grids_ ? grids_->triangles->activeVoxelCount() : 0; }

std::size_t DistanceField::memoryBytes() const {
  return grids_ ? grids_->triangles->memUsage() + grids_->distances->memUsage() : 0;
}

void DistanceField::save(const std::string& vdbFile) const {
  if (!grids_) throw InputError("The distance field is switched off, so there is nothing to save.");
  openvdb::initialize();
  openvdb::GridPtrVec grids{grids_->triangles, grids_->distances};
  grids_->triangles->setName(kTriangles);
  grids_->distances->setName(kDistances);
  for (const auto& grid : grids) {
    grid->insertMeta(kHash, openvdb::Int64Metadata(static_cast<openvdb::Int64>(model_.contentHash())));
    grid->insertMeta(kVoxelSize, openvdb::DoubleMetadata(grids_->size));
  }
  // Under another name first: whoever reads the cache meanwhile finds the old file or the new one, never a
  // part.
  const std::string unfinished = fmt::format("{}.{}.part", vdbFile, ::getpid());
  try {
    openvdb::io::File file(unfinished);
    file.write(grids);
    file.close();
    std::filesystem::rename(unfinished, vdbFile);
  } catch (const std::exception& e) {
    std::error_code ignored;
    std::filesystem::remove(unfinished, ignored);
    throw InputError(fmt::format("Cannot write the distance field to {}: {}.", vdbFile, e.what()));
  }
}

bool DistanceField::load(const std::string& vdbFile) {
  if (!grids_) return false;
  openvdb::initialize();
  openvdb::Int32Grid::Ptr triangles;
  openvdb::FloatGrid::Ptr distances;
  try {
    openvdb::io::File file(vdbFile);
    file.open(false);
    triangles = openvdb::gridPtrCast<openvdb::Int32Grid>(file.readGrid(kTriangles));
    distances = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid(kDistances));
    if (!triangles || !distances) return false;
    if (triangles->metaValue<openvdb::Int64>(kHash) != static_cast<openvdb::Int64>(model_.contentHash()) ||
        triangles->metaValue<double>(kVoxelSize) != grids_->size)
      return false;
  } catch (const std::exception&) {
    return false;  // no file, or none of ours: a cache that is not there
  }
  for (auto it = triangles->cbeginValueAll(); it; ++it)
    if (*it < kNone || *it >= model_.triangleCount()) return false;
  grids_->triangles = triangles;
  grids_->distances = distances;
  return true;
}

}  // namespace pm
