// SPDX-License-Identifier: BSD-3-Clause
#include "vtkDetectFeatures.h"

#include "FeatureEdges.h"
#include "FeaturePacking.h"
#include "Monitor.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

vtkStandardNewMacro(vtkDetectFeatures);

vtkDetectFeatures::vtkDetectFeatures() : vtkMeshStage(2, 0, 1) {
  const pm::FeatureOptions defaults;
  this->SharpAngle = defaults.sharpAngle;
  this->CornerAngle = defaults.cornerAngle;
  this->Interfaces = defaults.interfaces;
  this->OpenEdges = defaults.openEdges;
  this->Intersections = defaults.intersections;
  this->GapTolerance = defaults.gapTolerance;
  this->ShortestCurve = defaults.shortestCurve;
}

int vtkDetectFeatures::FillInputPortInformation(int port, vtkInformation* info) {
  if (port == 1) return DescribeOptionalPort(info);
  return this->Superclass::FillInputPortInformation(port, info);
}

int vtkDetectFeatures::FillOutputPortInformation(int, vtkInformation* info) {
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkPolyData");
  return 1;
}

void vtkDetectFeatures::Run(vtkInformationVector** inputs, vtkUnstructuredGrid*, vtkPolyData*,
                            pm::Monitor& monitor) {
  const auto model = this->Surface(inputs);
  pm::FeatureOptions options;
  options.sharpAngle = this->SharpAngle;
  options.cornerAngle = this->CornerAngle;
  options.interfaces = this->Interfaces;
  options.openEdges = this->OpenEdges;
  options.intersections = this->Intersections;
  options.gapTolerance = this->GapTolerance;
  options.shortestCurve = this->ShortestCurve;
  options.given = pm::curvesFrom(vtkDataObject::GetData(inputs[1]));
  pm::PartMonitor detection(monitor, 0.1, 0.9);
  const pm::FeatureGraph graph = pm::detectFeatures(*model, options, &detection);
  monitor.check(0.9, "packing curves");
  pm::packCurves(graph, vtkPolyData::SafeDownCast(this->GetOutputDataObject(0)));
}

void vtkDetectFeatures::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "SharpAngle: " << this->SharpAngle << "\n";
  os << indent << "CornerAngle: " << this->CornerAngle << "\n";
  os << indent << "Interfaces: " << this->Interfaces << "\n";
  os << indent << "OpenEdges: " << this->OpenEdges << "\n";
  os << indent << "Intersections: " << this->Intersections << "\n";
  os << indent << "GapTolerance: " << this->GapTolerance << "\n";
  os << indent << "ShortestCurve: " << this->ShortestCurve << "\n";
}
