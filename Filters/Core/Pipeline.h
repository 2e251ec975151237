// SPDX-License-Identifier: BSD-3-Clause
// The six stages in a row, without leaving the kernel.
#pragma once

#include "BoundaryRefine.h"
#include "CloseHoles.h"
#include "DummyLayer.h"
#include "OctreeDecompose.h"
#include "PaintFront.h"
#include "Project.h"
#include "ResolveFeatures.h"

namespace pm {

struct PipelineOptions {
  HoleMethod closeHoles = HoleMethod::ShowOnly;  ///< how holes are closed first; ShowOnly = they are not
  OctreeDecomposeOptions octree;
  PaintFrontOptions front;
  DummyLayerOptions layer;
  ProjectOptions project;
  ResolveFeaturesOptions features;
  BoundaryRefineOptions refine;
  Stage stopAfter = Stage::Refined;  ///< Front or later
};

struct PipelineReport {
  CloseHolesReport holes;
  PaintFrontReport front;
  ResolveFeaturesReport features;
  BoundaryRefineReport refine;
};

PolyMesh runPipeline(const SurfaceModel& model, const PipelineOptions& options, Monitor& monitor,
                     PipelineReport* report = nullptr);

}  // namespace pm
