// SPDX-License-Identifier: BSD-3-Clause
// What layers are wanted on which patch, and what follows for columns and prism edges (thesis 4.8: layers
// near all or user-defined boundaries).
#pragma once

#include <string>
#include <vector>

#include "LayerColumns.h"
#include "LayerPoints.h"

namespace pm {

/// Layers wanted on a wall. Lengths are in the geometry's units. Of the heights at most one is given, or the
/// first height and the thickness: then the expansion follows from them.
struct LayerSpec {
  int layers = 3;          ///< cells across the layer
  double expansion = 1.2;  ///< height ratio of a layer to the one nearer the wall
  double firstHeight = 0;  ///< height at the wall; 0 = from the others
  double thickness = 0;    ///< height of all layers; 0 = from the others
  double yPlus = 0;        ///< y+ of the first cell's centre, by FlowData; 0 = from the others
};

/// How layers pass into the cells behind them.
enum class LayerEnd : std::uint8_t {
  LastFills,  ///< the last layer takes what is left of the prism
  EvenGrowth  ///< layers of a given first height grow faster, by one ratio, where the prism is higher than
              ///< they need; before that, prism and cell behind are divided anew, as far as points may move
};

/// Layers on patches of their own.
struct PatchLayers {
  std::string patches;  ///< a name; * stands for any characters, ? for one
  LayerSpec spec;       ///< 0 layers: the prisms stay whole
};

/// The flow that a y+ is for, in units that go together with the geometry's.
struct FlowData {
  double speed = 0;      ///< along the wall, outside the layer
  double length = 0;     ///< from where the layer starts to grow
  double viscosity = 0;  ///< kinematic
};

/// Height of the first cell, twice the distance of its centre, on a flat plate: y = y+ nu / u_tau with
/// u_tau^2 = cf U^2 / 2 and the local friction cf = 0.664 Re^(-1/2) up to Re = U L / nu = 5e5 (Blasius),
/// above 0.026 Re^(-1/7) (Prandtl's power law).
double flatPlateHeight(double yPlus, const FlowData& flow);

/// A spec with its heights worked out. first is 0 where the layers share the prism's height.
struct LayerDemand {
  Id layers = 1;
  double first = 0, expansion = 1;
};

class LayerDemands {
 public:
  /// Throws InputError where a spec is not possible or contradicts itself, or a pattern fits no wall patch.
  /// Of several patterns that fit a patch the last one counts.
  LayerDemands(const PolyMesh& mesh, const LayerSpec& everywhere, const std::vector<PatchLayers>& patches,
               const FlowData& flow);

  const LayerDemand& of(Id patch) const { return ofPatch_[patch]; }
  Id mostLayers() const;
  /// Of a column: that of its wall faces with the most layers.
  const LayerDemand& ofColumn(const PolyMesh& mesh, const LayerColumns& columns, Id column) const;

 private:
  std::vector<LayerDemand> ofPatch_;
};

/// Heights on each prism edge, #P by lower point: the thinnest layers that a column around the edge wants. A
/// height above the wall becomes a length along the edge, which leans where the wall bends.
std::vector<EdgeHeights> edgeHeights(const PolyMesh& mesh, const LayerColumns& columns,
                                     const LayerDemands& demands, LayerEnd end);

/// Sizes of the cells behind the prisms at each edge: cube roots of volumes, the smallest around it. #P by
/// lower point, 0 where there is none.
std::vector<double> sizesBehind(const PolyMesh& mesh, const LayerColumns& columns);

/// Length that each edge needs for all layers of the columns around it, #P by lower point; 0 where the layers
/// share what there is. behind: from sizesBehind(), where the layers are to grow evenly into those cells;
/// then prism and cell behind are divided anew, as layers and one layer more. Else empty.
std::vector<double> wantedLengths(const PolyMesh& mesh, const LayerColumns& columns,
                                  const LayerDemands& demands, const std::vector<EdgeHeights>& heights,
                                  const std::vector<double>& behind);

}  // namespace pm
