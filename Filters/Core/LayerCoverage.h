// SPDX-License-Identifier: BSD-3-Clause
// What a mesh has of the layers that were wanted: face by face, and patch by patch.
#pragma once

#include <array>

#include "LayerDemands.h"

namespace pm {

/// #B, beside the boundary faces of the refined mesh; 0 where a face is not on a wall. A height is how
/// far a cell's inner end is above the wall, on average over the prism's edges (volume over area where the
/// cell is no prism); growths are those of layerGrowth().
struct WallFaceLayers {
  std::vector<std::uint8_t> layers;
  std::vector<LayerReason> reason;  ///< why fewer than wanted
  std::vector<double> firstHeight;  ///< of the cell at the wall
  std::vector<double> wantedFirst;  ///< first height asked for, or its share of the prism's height there
  std::vector<double> thickness;    ///< of all layers
  std::vector<double> growthInside, growthOutside;
};

/// Sums over a patch's faces. Shares are of its area.
struct PatchCoverage {
  std::string name;
  Id faces = 0;
  double area = 0;
  Id wantedLayers = 1;
  double layers = 0;       ///< on average
  double allLayers = 0;    ///< share with as many as wanted
  double covered = 0;      ///< share with a layer at the wall: two or more where that is wanted
  double asWanted = 0;     ///< share of what is covered with a first height within 20% of the wanted one
  double wantedFirst = 0;  ///< first height, on average
  double meanFirst = 0, minFirst = 0;  ///< of what is covered
  double thickness = 0;                ///< on average
  double growthInside95 = 0;           ///< where there are several layers; 95% of that area has less
  double growthOutside = 0, growthOutside95 = 0;  ///< median, and what 95% of the area has less of
  std::array<Id, kLayerReasons> byReason{};
};

struct BoundaryRefineReport {
  Id wallFaces = 0;
  std::vector<Id> facesByLayers;  ///< how many wall faces got 1, 2, .. layers
  WallFaceLayers faces;
  std::vector<PatchCoverage> patches;  ///< walls with faces, and their sum where there are several
};

/// refined: what splitLayers() has made of the columns.
BoundaryRefineReport coverage(const PolyMesh& refined, const LayerColumns& columns,
                              const LayerDemands& demands);

}  // namespace pm
