# SPDX-License-Identifier: BSD-3-Clause
"""What the tests share: geometry, the chain of filters, and the comparison of data sets to the bit."""
import numpy as np
import vtkmodules.vtkCommonCore  # noqa: F401  (VTK's core must load before modules built on it)
from projection_mesher import ProjectionMesherFilters as pm
from vtkmodules.util.misc import calldata_type
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import VTK_STRING
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersSources import vtkCubeSource, vtkPolyLineSource, vtkSphereSource

STAGES = ("vtkOctreeDecompose", "vtkPaintFront", "vtkDummyLayer", "vtkProject", "vtkResolveFeatures",
          "vtkBoundaryRefine")
WITH_GEOMETRY = {"vtkPaintFront": 1, "vtkProject": 1, "vtkResolveFeatures": 1}  # input port


def sphere(resolution=24, radius=0.5):
    source = vtkSphereSource()
    source.SetRadius(radius)
    source.SetThetaResolution(resolution)
    source.SetPhiResolution(resolution)
    source.Update()
    return source.GetOutput()


def box(x=1.0, y=1.0, z=1.0):
    """A cuboid of quads about the origin."""
    source = vtkCubeSource()
    source.SetXLength(x)
    source.SetYLength(y)
    source.SetZLength(z)
    source.Update()
    return source.GetOutput()


def polyline(points):
    source = vtkPolyLineSource()
    source.SetNumberOfPoints(len(points))
    for i, point in enumerate(points):
        source.SetPoint(i, *point)
    source.Update()
    return source.GetOutput()


def validity(mesh):
    check = pm.vtkMeshValidity()
    check.SetInputDataObject(mesh)
    check.Update()
    return check


def chain(geometry, size, last=len(STAGES), **properties):
    """The first `last` stages, connected and updated; properties go to every stage that has them."""
    stages = []
    for name in STAGES[:last]:
        stage = getattr(pm, name)()
        if not stages:
            stage.SetInputDataObject(0, geometry)
            stage.SetFeatureSize(size)
        else:
            stage.SetInputConnection(0, stages[-1].GetOutputPort(0))
            if name in WITH_GEOMETRY:
                stage.SetInputDataObject(WITH_GEOMETRY[name], geometry)
        for key, value in properties.items():
            if hasattr(stage, "Set" + key):
                getattr(stage, "Set" + key)(value)
        stages.append(stage)
    stages[-1].Update()
    return stages


def arrays(data):
    """Everything a grid or a surface holds, by name, as numpy arrays."""
    found = {"points": vtk_to_numpy(data.GetPoints().GetData())}
    cells = data.GetPolys() if isinstance(data, vtkPolyData) else data.GetCells()
    found["connectivity"] = vtk_to_numpy(cells.GetConnectivityArray())
    found["offsets"] = vtk_to_numpy(cells.GetOffsetsArray())
    if not isinstance(data, vtkPolyData):
        found["types"] = vtk_to_numpy(data.GetCellTypesArray())
        if data.GetFaces():
            found["faces"] = vtk_to_numpy(data.GetFaces())
            found["face locations"] = vtk_to_numpy(data.GetFaceLocations())
    for kind, attributes in (("cell", data.GetCellData()), ("point", data.GetPointData()), ("field", data.GetFieldData())):
        for i in range(attributes.GetNumberOfArrays()):
            array = attributes.GetAbstractArray(i)
            if array.IsA("vtkStringArray"):
                values = np.array([array.GetValue(k) for k in range(array.GetNumberOfValues())])
            else:
                values = vtk_to_numpy(array)
            found[f"{kind} {array.GetName()}"] = values
    return found


def differences(a, b, ignore=()):
    """Names of the arrays in which two data sets differ by a bit or more; empty when equal."""
    left, right = arrays(a), arrays(b)
    names = (set(left) | set(right)) - set(ignore)
    return sorted(n for n in names if n not in left or n not in right or left[n].dtype.kind != right[n].dtype.kind
                  or not np.array_equal(left[n], right[n]))


def strings(data, name):
    array = data.GetFieldData().GetAbstractArray(name)
    return [array.GetValue(i) for i in range(array.GetNumberOfValues())] if array else []


class Messages:
    """Collects the errors and warnings of an algorithm instead of printing them."""

    def __init__(self, algorithm):
        self.errors, self.warnings = [], []
        self.error_observer = self._collect(self.errors)
        self.warning_observer = self._collect(self.warnings)
        algorithm.AddObserver("ErrorEvent", self.error_observer)
        algorithm.AddObserver("WarningEvent", self.warning_observer)
        executive_errors = self._collect([])  # the executive repeats that the algorithm failed
        algorithm.GetExecutive().AddObserver("ErrorEvent", executive_errors)

    @staticmethod
    def _collect(into):
        @calldata_type(VTK_STRING)
        def observer(_object, _event, text):
            into.append(text)
        return observer
