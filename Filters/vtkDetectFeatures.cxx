// SPDX-License-Identifier: BSD-3-Clause
#include "vtkDetectFeatures.h"

#include "FeatureEdges.h"
#include "Monitor.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

vtkStandardNewMacro(vtkDetectFeatures);

vtkDetectFeatures::vtkDetectFeatures() : vtkMeshStage(1, 0, 1) {
  const pm::FeatureOptions defaults;
  this->SharpAngle = defaults.sharpAngle;
  this->CornerAngle = defaults.cornerAngle;
  this->Interfaces = defaults.interfaces;
  this->OpenEdges = defaults.openEdges;
  this->Intersections = defaults.intersections;
  this->GapTolerance = defaults.gapTolerance;
  this->ShortestCurve = defaults.shortestCurve;
}

int vtkDetectFeatures::FillOutputPortInformation(int, vtkInformation* info) {
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkPolyData");
  return 1;
}

namespace {

/// Corners as vertices, curves as polylines, with their arrays.
class CurvePacker {
 public:
  CurvePacker() {
    this->Points->SetDataTypeToDouble();
    this->Kind->SetName("Kind");
    this->Curve->SetName("Curve");
    this->Length->SetName("Length");
  }

  void Pack(const pm::FeatureGraph& graph, vtkPolyData* out) {
    for (const pm::Vec3& corner : graph.corners()) {
      const vtkIdType point = this->Points->InsertNextPoint(corner.data());
      this->Vertices->InsertNextCell(1, &point);
      this->AddValues(0, -1, 0);
    }
    std::vector<int> kinds(graph.curves().size(), 0);
    for (const pm::FeatureSegment& segment : graph.segments()) kinds[segment.curve] |= segment.kind;
    for (std::size_t c = 0; c < graph.curves().size(); ++c)
      this->AddCurve(graph.curves()[c], kinds[c], static_cast<int>(c));
    out->SetPoints(this->Points);
    out->SetVerts(this->Vertices);
    out->SetLines(this->Lines);
    out->GetCellData()->AddArray(this->Kind);
    out->GetCellData()->AddArray(this->Curve);
    out->GetCellData()->AddArray(this->Length);
  }

 private:
  void AddCurve(const pm::FeatureCurve& curve, int kind, int number) {
    const vtkIdType first = this->Points->GetNumberOfPoints();
    const vtkIdType count = static_cast<vtkIdType>(curve.points.size());
    this->Lines->InsertNextCell(count + (curve.closed ? 1 : 0));
    for (const pm::Vec3& p : curve.points)
      this->Lines->InsertCellPoint(this->Points->InsertNextPoint(p.data()));
    if (curve.closed) this->Lines->InsertCellPoint(first);
    this->AddValues(kind, number, curve.length());
  }

  void AddValues(int kind, int curve, double length) {
    this->Kind->InsertNextValue(kind);
    this->Curve->InsertNextValue(curve);
    this->Length->InsertNextValue(length);
  }

  vtkNew<vtkPoints> Points;
  vtkNew<vtkCellArray> Vertices, Lines;
  vtkNew<vtkIntArray> Kind, Curve;
  vtkNew<vtkDoubleArray> Length;
};

}  // namespace

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
  pm::PartMonitor detection(monitor, 0.1, 0.9);
  const pm::FeatureGraph graph = pm::detectFeatures(*model, options, &detection);
  monitor.check(0.9, "packing curves");
  CurvePacker().Pack(graph, vtkPolyData::SafeDownCast(this->GetOutputDataObject(0)));
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
