// SPDX-License-Identifier: BSD-3-Clause
#include "vtkResolveFeatures.h"

#include "FeaturePacking.h"
#include "MeshPacking.h"
#include "ResolveFeatures.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

vtkStandardNewMacro(vtkResolveFeatures);

vtkResolveFeatures::vtkResolveFeatures() : vtkFoamLimitsStage(3, 1) {
  const pm::ResolveFeaturesOptions defaults;
  this->SharpAngle = defaults.features.sharpAngle;
  this->CornerAngle = defaults.features.cornerAngle;
  this->Interfaces = defaults.features.interfaces;
  this->OpenEdges = defaults.features.openEdges;
  this->Intersections = defaults.features.intersections;
  this->GapTolerance = defaults.features.gapTolerance;
  this->ShortestCurve = defaults.features.shortestCurve;
  this->Rounds = defaults.rounds;
  this->SetNumberOfOutputPorts(UNRESOLVED + 1);
}

int vtkResolveFeatures::FillInputPortInformation(int port, vtkInformation* info) {
  return port == 2 ? DescribeOptionalPort(info) : this->Superclass::FillInputPortInformation(port, info);
}

pm::ResolveFeaturesOptions vtkResolveFeatures::Options(vtkDataObject* curves) const {
  pm::ResolveFeaturesOptions options;
  options.features.sharpAngle = this->SharpAngle;
  options.features.cornerAngle = this->CornerAngle;
  options.features.interfaces = this->Interfaces;
  options.features.openEdges = this->OpenEdges;
  options.features.intersections = this->Intersections;
  options.features.gapTolerance = this->GapTolerance;
  options.features.shortestCurve = this->ShortestCurve;
  options.features.given = pm::curvesFrom(curves);
  options.rounds = this->Rounds;
  options.limits = this->Limits();
  return options;
}

void vtkResolveFeatures::Run(vtkInformationVector** inputs, vtkUnstructuredGrid* mesh, vtkPolyData* boundary,
                             pm::Monitor& monitor) {
  this->FeatureLength = this->ResolvedLength = 0;
  this->Corners = this->ResolvedCorners = 0;
  const pm::ResolveFeaturesOptions options = this->Options(vtkDataObject::GetData(inputs[2]));
  pm::PolyMesh result =
      pm::unpackMesh(vtkUnstructuredGrid::GetData(inputs[0]), "Resolve Features", {pm::Stage::Projected});
  DoneWith(inputs[0]);
  const auto model = this->Surface(inputs);
  pm::DistanceField field(*model, result.finestSize);
  pm::ResolveFeaturesReport report;
  pm::resolveFeatures(result, field, options, monitor, &report);
  this->FeatureLength = report.featureLength;
  this->ResolvedLength = report.resolvedLength;
  this->Corners = report.corners;
  this->ResolvedCorners = report.resolvedCorners;
  pm::packMesh(result, mesh);
  pm::packBoundary(result, boundary);
  pm::packUnresolved(report.unresolved, vtkPolyData::SafeDownCast(this->GetOutputDataObject(UNRESOLVED)));
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
