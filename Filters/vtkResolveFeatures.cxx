// SPDX-License-Identifier: BSD-3-Clause
#include "vtkResolveFeatures.h"

#include "MeshPacking.h"
#include "ResolveFeatures.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

vtkStandardNewMacro(vtkResolveFeatures);

vtkResolveFeatures::vtkResolveFeatures() : vtkFoamLimitsStage(2, 1) {
  const pm::ResolveFeaturesOptions defaults;
  this->SharpAngle = defaults.features.sharpAngle;
  this->CornerAngle = defaults.features.cornerAngle;
  this->Interfaces = defaults.features.interfaces;
  this->OpenEdges = defaults.features.openEdges;
  this->Intersections = defaults.features.intersections;
  this->GapTolerance = defaults.features.gapTolerance;
  this->ShortestCurve = defaults.features.shortestCurve;
  this->Rounds = defaults.rounds;
}

pm::ResolveFeaturesOptions vtkResolveFeatures::Options() const {
  pm::ResolveFeaturesOptions options;
  options.features.sharpAngle = this->SharpAngle;
  options.features.cornerAngle = this->CornerAngle;
  options.features.interfaces = this->Interfaces;
  options.features.openEdges = this->OpenEdges;
  options.features.intersections = this->Intersections;
  options.features.gapTolerance = this->GapTolerance;
  options.features.shortestCurve = this->ShortestCurve;
  options.rounds = this->Rounds;
  options.limits = this->Limits();
  return options;
}

void vtkResolveFeatures::Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
                             pm::Monitor& monitor) {
  this->FeatureLength = this->ResolvedLength = 0;
  this->Corners = this->ResolvedCorners = 0;
  pm::PolyMesh result =
      pm::unpackMesh(vtkUnstructuredGrid::GetData(inputs[0]), "Resolve Features", {pm::Stage::Projected});
  const auto model = this->Surface(inputs);
  pm::DistanceField field(*model, result.finestSize);
  pm::ResolveFeaturesReport report;
  pm::resolveFeatures(result, field, this->Options(), monitor, &report);
  this->FeatureLength = report.featureLength;
  this->ResolvedLength = report.resolvedLength;
  this->Corners = report.corners;
  this->ResolvedCorners = report.resolvedCorners;
  pm::packMesh(result, mesh);
  pm::packBoundary(result, boundary);
}

void vtkResolveFeatures::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "SharpAngle: " << this->SharpAngle << "\n";
  os << indent << "CornerAngle: " << this->CornerAngle << "\n";
  os << indent << "Interfaces: " << this->Interfaces << "\n";
  os << indent << "OpenEdges: " << this->OpenEdges << "\n";
  os << indent << "Intersections: " << this->Intersections << "\n";
  os << indent << "GapTolerance: " << this->GapTolerance << "\n";
  os << indent << "ShortestCurve: " << this->ShortestCurve << "\n";
  os << indent << "Rounds: " << this->Rounds << "\n";
  os << indent << "ResolvedLength: " << this->ResolvedLength << " of " << this->FeatureLength << "\n";
  os << indent << "ResolvedCorners: " << this->ResolvedCorners << " of " << this->Corners << "\n";
}
