// SPDX-License-Identifier: BSD-3-Clause
// Why a leaf of the octree is as small as it is: the criterion that split its parent.
#pragma once

#include <array>
#include <cstdint>

namespace pm {

/// Codes 1-9 are the criteria of thesis 3.4.4; the others are ours. Stored in Octree::refinedBy.
enum class RefineReason : std::uint8_t {
  Root = 0,           ///< a root cell: nothing was split
  CellNormals = 1,    ///< normals of the triangles within the cell
  Normals = 2,        ///< normals against those of an adjacent cell
  CellFacing = 3,     ///< surfaces that face each other within the cell
  Facing = 4,         ///< surfaces that face each other across adjacent cells
  Feature = 5,        ///< a critical edge or point in the cell
  Balance = 6,        ///< grading between levels
  FeatureBuffer = 7,  ///< close to a critical edge
  SmallerCut = 8,     ///< beside a smaller cell that the surface cuts
  PatchSize = 9,      ///< a patch's own cell size
  SurfaceSize = 10,
  Box = 11,
  Sphere = 12,
  Cylinder = 13,
  PatchDistance = 14,    ///< within a distance of a patch
  SurfaceDistance = 15,  ///< within a distance of the size surface
  Gap = 16,              ///< cells across a gap
  Curvature = 17,        ///< cells per circle
  Island = 18,           ///< most neighbours on the surface were split
};

inline constexpr std::array<const char*, 19> kRefineReasonNames = {"root cell",
                                                                   "normals in cell",
                                                                   "normals across cells",
                                                                   "facing surfaces in cell",
                                                                   "facing surfaces",
                                                                   "feature",
                                                                   "balance",
                                                                   "near a feature",
                                                                   "smaller cut",
                                                                   "patch size",
                                                                   "surface size",
                                                                   "box",
                                                                   "sphere",
                                                                   "cylinder",
                                                                   "distance to a patch",
                                                                   "distance to the size surface",
                                                                   "gap",
                                                                   "curvature",
                                                                   "island"};

/// What split a cell, and the patch of the triangle that asked, kNone (-1) when none did.
struct RefineCause {
  RefineReason reason = RefineReason::Root;
  std::uint8_t level = 0;   ///< as deep it will ask as far as known, 0 = not known
  std::int16_t patch = -1;  ///< -1 also beyond 32,767, the most that are told apart
};

constexpr std::int16_t narrowPatch(std::int32_t patch) {
  return patch <= 0x7fff ? static_cast<std::int16_t>(patch) : std::int16_t(-1);
}

}  // namespace pm
