// SPDX-License-Identifier: BSD-3-Clause
// How evenly layers grow, from one to the next and into the cells behind them.
//
// The growth across a face is the distance of the farther cell's centre from it over that of the cell nearer
// the wall, both along the face's normal: of two boxes, the ratio of their heights.
#pragma once

#include "LayerColumns.h"

namespace pm {

/// Of a refined mesh, #C; set for the cells of layers and those beside them.
struct LayerCells {
  std::vector<double> volumes;
  std::vector<Vec3> centres;  ///< centres of mass of the cells as bounded by their faces' triangles
};
LayerCells measureLayerCells(const PolyMesh& refined);

/// The column of each cell of the mesh that splitLayers() has made, kNone for others. #C
std::vector<Id> columnsOfCells(const PolyMesh& refined, const LayerColumns& columns);

/// #columns
struct LayerGrowth {
  std::vector<double> inside;   ///< the largest from one layer to the next; 0 where there is one layer
  std::vector<double> outside;  ///< from the last layer to the cells behind it; 0 where there are none
};
LayerGrowth layerGrowth(const PolyMesh& refined, const LayerColumns& columns, const LayerCells& cells);

}  // namespace pm
