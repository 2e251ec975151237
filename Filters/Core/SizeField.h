// SPDX-License-Identifier: BSD-3-Clause
// The cell sizes a user gives for parts of space: boxes, spheres, cylinders, distances from patches and from
// a surface of its own.
//
// A shape limits every cell that it touches, however little. For boxes and spheres that is decided exactly.
// Cylinders and distances are decided from a distance function at the cell's centre and, in doubt, at those
// of its eighths, three times over: a cell may count as touched that lies an eighth of its diagonal off,
// never the other way round.
#pragma once

#include <memory>
#include <vector>

#include "OctreeDecompose.h"
#include "RefineReason.h"

namespace pm {

class SizeField {
 public:
  /// Keeps references to the model and the options.
  SizeField(const SurfaceModel& model, const OctreeDecomposeOptions& options);
  ~SizeField();

  bool empty() const;
  /// The first shape that asks for cells smaller than `edge` where the cell lies; `limit` gets its size.
  /// RefineReason::Root when none does. Thread-safe.
  RefineCause asks(const Box& cell, double edge, double& limit) const;

 private:
  struct Near {  // cells within a distance of a surface
    std::shared_ptr<const SurfaceModel> surface;
    double distance, size;
    RefineCause cause;
  };
  void addPatchDistances(const SurfaceModel& model);

  const OctreeDecomposeOptions& options_;
  std::vector<Near> near_;
};

}  // namespace pm
