// SPDX-License-Identifier: BSD-3-Clause
// Why a wall face has fewer layers than were wanted.
#pragma once

#include <cstdint>

namespace pm {

/// The numbers are those of the array LayerReason; new ones are appended.
enum class LayerReason : std::uint8_t {
  None = 0,        ///< it has all
  NotWanted,       ///< its patch is to have none
  NoPrism,         ///< the cell behind it is no prism
  NoRoom,          ///< the prism is not high enough for the heights asked for
  FoldedCell,      ///< a cell would have a central tetrahedron or a face's pyramid of no volume
  FaceShape,       ///< a face would be degenerate (4-13)
  Warpage,         ///< a face would be too warped
  AngleInternal,   ///< a face inside would be too oblique to the line between its cells
  AngleBoundary,   ///< a boundary face would be too oblique to the line to its cell
  Skewness,        ///< OpenFOAM's skewness of a face would be too large
  NeighbourLayers  ///< a neighbour has fewer; those side by side differ by one at most
};
constexpr int kLayerReasons = 11;

/// In words, e.g. "the prism is not high enough".
const char* describe(LayerReason reason);

}  // namespace pm
