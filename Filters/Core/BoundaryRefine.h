// SPDX-License-Identifier: BSD-3-Clause
// Stage 6: wall prisms split into boundary layers (thesis 4.8).
//
// Passes: prisms below cut wall faces become a prism for each part; lower ends of prism edges are moved where
// the layers wanted need room; every column is given the layers that fit, those side by side differing by one
// at most; where a cell or face would break a limit other shapes are searched, and layers taken away when
// there is none; the columns are split.
//
// Guarantees: wall points stay; the mesh keeps its limits (but for minVolume and the degradation of side
// faces: layers are thin on purpose); the same bits for any number of threads.
#pragma once

#include "LayerCoverage.h"
#include "MeshQuality.h"

namespace pm {

struct BoundaryRefineOptions : LayerSpec {  ///< the layers on all walls
  std::vector<PatchLayers> patches;         ///< and on walls of their own; the last that fits counts
  FlowData flow;                            ///< for y+
  LayerEnd end = LayerEnd::LastFills;       ///< how layers pass into the cells behind
  bool makeRoom = true;                     ///< may move lower ends of prism edges where layers need it
  QualityLimits limits;                     ///< minVolume is not applied: layers are thin on purpose
};

/// Moved in, the mesh is in memory once less.
PolyMesh boundaryRefine(PolyMesh mesh, const BoundaryRefineOptions& options, Monitor& monitor,
                        BoundaryRefineReport* report = nullptr);

}  // namespace pm
