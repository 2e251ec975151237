# SPDX-License-Identifier: BSD-3-Clause
"""The command line: what it leaves behind, and one clear sentence for every kind of bad input."""
import gzip
import os
import re
import shutil
import subprocess
import tempfile
import unittest

ROOT = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
DRIVER = os.path.join(ROOT, "Docs", "Examples", "mesh.py")
CLEAN = os.path.join(ROOT, "Testing", "Data", "pipe_junction.stl")


def mesh(*arguments, timeout=300):
    """Runs the driver that mesh.sh runs, with the build that is being tested."""
    return subprocess.run(["pvpython", DRIVER, *map(str, arguments)], capture_output=True, text=True, timeout=timeout,
                          check=False)


class MeshCommand(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.mkdtemp()
        self.out = os.path.join(self.directory, "out")

    def tearDown(self):
        shutil.rmtree(self.directory)

    def path(self, name, content=None):
        path = os.path.join(self.directory, name)
        if content is not None:
            with open(path, "w", encoding="ascii") as file:
                file.write(content)
        return path

    def refused(self, words, *arguments):
        """The command fails with one sentence on stderr that holds the words, and leaves no mesh."""
        done = mesh("-o", self.out, *arguments)
        self.assertNotEqual(done.returncode, 0, done.stdout)
        said = [line for line in done.stderr.splitlines() if line.strip() and not line.startswith("[")]  # not the bar
        self.assertEqual(len(said), 1, done.stderr)
        self.assertTrue(said[0].startswith("mesh.sh: "), said[0])
        self.assertTrue(said[0].endswith("."), said[0])
        self.assertNotIn("fault of the program", said[0])
        self.assertRegex(said[0].lower(), words)
        self.assertNotIn("Traceback", done.stderr)
        self.assertFalse(os.path.exists(os.path.join(self.out, "mesh.vtu")))

    # ------------------------------------------------------------------------------------------------ bad input
    def test_missing_file(self):
        self.refused("no file", self.path("nothing.stl"))

    def test_empty_file(self):
        self.refused("empty", self.path("empty.stl", ""))

    def test_file_without_triangles(self):
        self.refused("no triangles|no surface|cannot be read", self.path("bare.stl", "solid bare\nendsolid bare\n"))

    def test_file_of_another_kind(self):
        self.refused("stl", self.path("notes.txt", "not a geometry\n"))

    def test_nonsense_in_a_geometry_file(self):
        self.refused("triangles|read", self.path("nonsense.obj", "these are no triangles\n"))

    def test_coordinate_that_is_no_number(self):
        with open(CLEAN, encoding="ascii") as file:
            text = file.read()
        broken = re.sub(r"vertex \S+", "vertex nan", text, count=1)
        self.refused("finite|not a number|nan", self.path("nan.stl", broken))

    def test_feature_size_zero(self):
        self.refused("feature-size must be", CLEAN, "--feature-size", "0")

    def test_feature_size_negative(self):
        self.refused("feature-size must be", CLEAN, "--feature-size", "-1e-3")

    def test_feature_size_not_a_number(self):
        self.refused("feature-size", CLEAN, "--feature-size", "nan")
        self.refused("feature-size", CLEAN, "--feature-size", "small")

    def test_feature_size_larger_than_the_geometry(self):
        self.refused("feature size", CLEAN, "--feature-size", "1")

    def test_point_outside_the_domain(self):
        self.refused("point", CLEAN, "--feature-size", "0.005", "--point", "1", "1", "1")

    def test_region_that_leaks(self):
        """The junction without its inlet: nothing is enclosed."""
        with open(CLEAN, encoding="ascii") as file:
            text = file.read()
        open_model = text[text.index("solid wall"):]
        self.refused("leak|enclosed|open", self.path("open.stl", open_model), "--feature-size", "0.005",
                     "--point", "0.05", "0", "0")

    def test_box_of_no_size(self):
        self.refused("box", CLEAN, "--domain", "0", "0", "0", "0", "1", "1")

    def test_layers_that_contradict_themselves(self):
        self.refused("name and a number", CLEAN, "--patch-layers", "wall", "few")
        self.refused("flow must be", CLEAN, "--y-plus", "1", "--flow", "0", "1", "1")
        self.refused("needs the flow", CLEAN, "--feature-size", "0.006", "--y-plus", "1")
        self.refused("no wall is named", CLEAN, "--feature-size", "0.006", "--patch-layers", "nose*", "2")

    def test_unknown_stage_and_option(self):
        self.refused("no stage", CLEAN, "--stop-after", "later")
        self.refused("unrecognized", CLEAN, "--colour", "red")

    # ------------------------------------------------------------------------------------------------- good input
    def test_results_and_report(self):
        done = mesh(CLEAN, "-o", self.out, "--feature-size", "0.005", "--layers", "2", "--threads", "1",
                    "--also", "msh", "--also", "stl")
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in ("mesh.vtu", "boundary.vtp", "mesh.msh", "boundary.stl", "polyMesh/points", "polyMesh/faces", "polyMesh/owner",
                     "polyMesh/neighbour", "polyMesh/boundary"):
            self.assertGreater(os.path.getsize(os.path.join(self.out, name)), 100, name)
        with open(os.path.join(self.out, "polyMesh", "boundary"), encoding="ascii") as file:
            boundary = file.read()
        for patch in ("inlet", "wall", "outlet1", "outlet2", "outlet3"):
            self.assertIn(patch, boundary)
            self.assertRegex(done.stdout, rf"{patch} +[\d,]+ faces")
        self.assertRegex(done.stdout, r"faces and cells outside the limits +0\n")
        for stage in ("OctreeDecompose", "PaintFront", "DummyLayer", "Project", "ResolveFeatures", "BoundaryRefine"):
            self.assertRegex(done.stderr, rf"100% {stage}")
            self.assertRegex(done.stdout, rf"{stage} +\d+\.\d+ +\d+")

    def test_pictures(self):
        if not shutil.which("xvfb-run"):
            self.skipTest("pictures need xvfb-run")
        done = mesh(CLEAN, "-o", self.out, "--feature-size", "0.005", "--stop-after", "front")
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in ("section.png", "surface.png"):
            with open(os.path.join(self.out, name), "rb") as file:
                head = file.read(24)
            self.assertEqual(head[1:4], b"PNG")
            self.assertEqual([int.from_bytes(head[i:i + 4], "big") for i in (16, 20)], [1400, 1000])

    def test_far_field(self):
        for option, size, patch in (("--far-box", "1", "xmax"), ("--far-sphere", "2", "far")):
            done = mesh(CLEAN, "-o", self.out, "--domain", "-0.1", "-0.15", "-0.15", "0.25", "0.15", "0.15", "--feature-size", "0.01",
                        option, size)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout, rf"{patch} +[\d,]+ faces \(domain side\)")
            volume = float(re.search(r"total volume +(\S+)", done.stdout).group(1))
            self.assertGreater(volume, 2.0)

    def test_without_pictures(self):
        done = mesh(CLEAN, "-o", self.out, "--feature-size", "0.006", "--stop-after", "octree", "--no-pictures")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"voxels +[1-9]")
        self.assertEqual(os.listdir(self.out), ["mesh.vtu"])

    def test_gzipped_input_gives_the_same_mesh(self):
        packed = self.path("packed.stl.gz")
        with open(CLEAN, "rb") as plain, gzip.open(packed, "wb") as file:
            shutil.copyfileobj(plain, file)
        points = []
        for geometry in (CLEAN, packed):
            done = mesh(geometry, "-o", self.out, "--feature-size", "0.006", "--stop-after", "layer")
            self.assertEqual(done.returncode, 0, done.stderr)
            with open(os.path.join(self.out, "polyMesh", "points"), "rb") as file:
                points.append(file.read())
        self.assertEqual(points[0], points[1])


if __name__ == "__main__":
    unittest.main()
