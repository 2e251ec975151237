# SPDX-License-Identifier: BSD-3-Clause
"""The plugin in ParaView's own Python: proxies, properties of the same name, ports, reader and writer."""
import os
import tempfile
import unittest

from paraview import simple

simple.LoadPlugin(os.environ["PROJECTIONMESHER_PLUGIN"], remote=False, ns=globals())

FILTERS = ("OctreeDecompose", "PaintFront", "DummyLayer", "Project", "ResolveFeatures", "BoundaryRefine",
           "ProjectionMesh")


class TestPlugin(unittest.TestCase):
    def test_every_filter_has_a_function(self):
        for name in FILTERS + ("SurfaceReader",):
            self.assertIn(name, globals())

    def test_chain_and_one_filter(self):
        geometry = simple.Sphere(ThetaResolution=24, PhiResolution=24)
        octree = OctreeDecompose(Geometry=geometry, FeatureSize=0.1)
        front = PaintFront(Input=octree, Geometry=geometry, Region="Inside")
        layer = DummyLayer(Input=front)
        project = Project(Input=layer, Geometry=geometry)
        features = ResolveFeatures(Input=project, Geometry=geometry)
        refine = BoundaryRefine(Input=features, Layers=2)
        refine.UpdatePipeline()
        mesh = ProjectionMesh(Geometry=geometry, FeatureSize=0.1, Layers=2)
        mesh.UpdatePipeline()
        cells = refine.GetDataInformation().GetNumberOfCells()
        self.assertGreater(cells, 100)
        self.assertEqual(cells, mesh.GetDataInformation().GetNumberOfCells())
        self.assertEqual(mesh["Boundary"].GetDataInformation().GetDataSetTypeAsString(), "vtkPolyData")
        self.assertEqual(mesh["Mesh"].GetDataInformation().GetDataSetTypeAsString(), "vtkUnstructuredGrid")

    def test_repeatable_properties(self):
        geometry = simple.Sphere(ThetaResolution=24, PhiResolution=24)
        octree = OctreeDecompose(Geometry=geometry, FeatureSize=0.03, NormalAngle=60)
        octree.UpdatePipeline()
        plain = octree.GetDataInformation().GetNumberOfCells()
        octree.RefineBoxes = [0, 1, 0, 1, 0, 1, 0.03, -1, 0, -1, 0, -1, 0, 0.03]
        octree.UpdatePipeline()
        boxes = octree.GetDataInformation().GetNumberOfCells()
        self.assertGreater(boxes, plain)
        octree.RefineBoxes = []
        octree.PatchSizes = ["wall", "0.03"]
        octree.UpdatePipeline()
        self.assertGreater(octree.GetDataInformation().GetNumberOfCells(), plain)
        front = PaintFront(Input=octree, Geometry=geometry, Region="Points", SeedPoints=[0, 0, 0])
        front.UpdatePipeline()
        self.assertGreater(front.GetDataInformation().GetNumberOfCells(), 0)

    def test_save_data_as_foam(self):
        mesh = ProjectionMesh(Geometry=simple.Sphere(ThetaResolution=24, PhiResolution=24), FeatureSize=0.1)
        with tempfile.TemporaryDirectory() as folder:
            simple.SaveData(os.path.join(folder, "case.foam"), proxy=mesh, Binary=0)
            self.assertTrue(os.path.exists(os.path.join(folder, "constant", "polyMesh", "points")))
            foam = simple.OpenFOAMReader(FileName=os.path.join(folder, "case.foam"))
            foam.UpdatePipeline()
            self.assertIn("patch/wall", foam.MeshRegions.Available)
            self.assertGreater(foam.GetDataInformation().GetNumberOfCells(), 100)

    def test_open_data_file(self):
        import gzip
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "tri.obj.gz")
            with gzip.open(path, "wt") as file:
                file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\ng part\nf 1 2 3\n")
            reader = simple.OpenDataFile(path)
            self.assertEqual(reader.GetXMLName(), "SurfaceReader")
            reader.UpdatePipeline()
            self.assertEqual(reader.GetDataInformation().GetNumberOfCells(), 1)


if __name__ == "__main__":
    unittest.main()
