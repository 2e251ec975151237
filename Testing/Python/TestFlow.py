# SPDX-License-Identifier: BSD-3-Clause
"""The examples that run OpenFOAM on a mesh: their dictionaries, their refusals, and, where OpenFOAM is installed, the flow
through a coarse junction and around a sphere."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOGeometry import vtkSTLWriter

ROOT = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
EXAMPLES = os.path.join(ROOT, "Docs", "Examples")
sys.path.append(EXAMPLES)
import flow_pictures  # noqa: E402  only now can it be found

CASES = {"junction_flow": ["inlet", "wall", "outlet1", "outlet2", "outlet3"],
         "motorbike_potential": ["frt-fairing_001_1", "xmin", "xmax", "ymin", "ymax", "zmin", "zmax"]}
COARSE = 0.004  # m, a feature size
MIDDLE, RADIUS = (1.0, 0.0, 1.25), 0.5  # m, of a sphere in the motorcycle's place
TOOLS = ("bash", "sh", "dirname", "basename", "cat", "awk", "grep", "mkdir", "realpath")


def run(*command, **environment):
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=280, check=False,
                          env={**os.environ, **environment})


def parse(text):
    """A dictionary file as nested dicts; values as the words up to the semicolon."""
    text = re.sub(r"//[^\n]*", "", text)
    words = re.findall(r'"[^"]*"|[{};]|\[[^\]]*\]|[^\s{};"\[\]]+', text)
    stack, entry = [{}], []
    for word in words:
        if word == "{":
            stack.append(stack[-1].setdefault(" ".join(entry), {}))
            entry = []
        elif word == "}":
            if entry or len(stack) == 1:
                raise ValueError(f"an entry without a semicolon or a brace too many near {entry}")
            stack.pop()
        elif word == ";":
            if entry:
                stack[-1][entry[0]] = entry[1:]
            entry = []
        else:
            entry.append(word)
    if entry or len(stack) != 1:
        raise ValueError(f"the file ends within an entry or a block: {entry}")
    return stack[0]


def files_of(case):
    for where, _, names in os.walk(os.path.join(EXAMPLES, case)):
        for name in names:
            with open(os.path.join(where, name), encoding="ascii") as file:
                yield os.path.basename(where), name, parse(file.read())


class Dictionaries(unittest.TestCase):
    def test_each_names_itself(self):
        for case in CASES:
            found = list(files_of(case))
            self.assertGreaterEqual(len(found), 5)
            for folder, name, content in found:
                with self.subTest(case=case, file=name):
                    self.assertEqual(content["FoamFile"]["object"], [name])
                    self.assertEqual(content["FoamFile"]["class"] == ["dictionary"], folder != "0")

    def test_fields_cover_all_patches(self):
        for case, patches in CASES.items():
            for folder, name, content in files_of(case):
                if folder != "0":
                    continue
                for patch in patches:
                    keys = [key for key in content["boundaryField"]
                            if key == patch or key[0] == '"' and re.fullmatch(key.strip('"'), patch)]
                    with self.subTest(case=case, field=name, patch=patch):
                        self.assertTrue(keys)
                        self.assertTrue(all(content["boundaryField"][key]["type"] for key in keys))

    def test_parser_sees_what_is_wrong(self):
        for text in ("a { b 1; ", "a { b 1 }", "b 1; }", "a 1"):
            with self.assertRaises(ValueError):
                parse(text)


class Scripts(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.mkdtemp()
        self.out = os.path.join(self.directory, "out")
        self.mesher = os.path.join(self.directory, "mesher")
        with open(self.mesher, "w", encoding="ascii") as file:
            file.write(f'#!/bin/sh\nexec pvpython "{EXAMPLES}/mesh.py" "$@"\n')
        os.chmod(self.mesher, 0o755)

    def tearDown(self):
        shutil.rmtree(self.directory)

    def without_openfoam(self):
        """A PATH with what the scripts need, but not OpenFOAM."""
        tools = os.path.join(self.directory, "tools")
        os.mkdir(tools)
        for tool in TOOLS:
            os.symlink(shutil.which(tool), os.path.join(tools, tool))
        return tools

    def with_stand_ins(self):
        """The same with programs of OpenFOAM's names that do nothing, for refusals that come before they run."""
        tools = self.without_openfoam()
        for program in ("simpleFoam", "potentialFoam"):
            os.symlink(shutil.which("true"), os.path.join(tools, program))
        return tools

    def refused(self, done, words):
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertEqual(done.stderr.strip().count("\n"), 0, done.stderr)
        self.assertRegex(done.stderr, words)

    def test_says_which_package_is_missing(self):
        tools = self.without_openfoam()
        for script in ("junction_flow.sh", "motorbike_potential.sh"):
            done = run(shutil.which("bash"), os.path.join(EXAMPLES, script), self.out, PATH=tools)
            self.refused(done, r"^\w+\.sh: OpenFOAM's \w+ is missing; install Debian's package openfoam.*\.$")
            self.assertFalse(os.path.exists(self.out))

    def test_missing_geometry(self):
        done = run(os.path.join(EXAMPLES, "motorbike_potential.sh"), self.out, 0.1, os.path.join(self.directory, "none.obj"),
                   PATH=self.with_stand_ins())
        self.refused(done, "There is no file .*none.obj; install .*openfoam-examples")

    def test_a_case_is_not_overwritten(self):
        os.makedirs(os.path.join(self.out, "case"))
        done = run(os.path.join(EXAMPLES, "junction_flow.sh"), self.out, PATH=self.with_stand_ins())
        self.refused(done, "There is a case in .*/out/case already")
        self.assertEqual(os.listdir(self.out), ["case"])

    def test_a_failed_mesh_ends_it(self):
        done = run(os.path.join(EXAMPLES, "junction_flow.sh"), self.out, PATH=self.with_stand_ins(),
                   MESHER=shutil.which("false"))
        self.refused(done, "There is no mesh to run on")

    def test_other_patches(self):
        with open(self.mesher, "w", encoding="ascii") as file:
            file.write('#!/bin/sh\nmkdir -p "$2/polyMesh"\nprintf "    inlet\\n    walls\\n" > "$2/polyMesh/boundary"\n')
        done = run(os.path.join(EXAMPLES, "junction_flow.sh"), self.out, PATH=self.with_stand_ins(), MESHER=self.mesher)
        self.refused(done, "The mesh has no patch wall; name the geometry's solids inlet wall outlet1 outlet2 outlet3")

    def test_blank_in_the_path(self):
        done = run(os.path.join(EXAMPLES, "junction_flow.sh"), self.out + " 2", PATH=self.with_stand_ins())
        self.refused(done, "no folder with a blank in its path")

    def test_report_tells_what_is_wrong(self):
        case = os.path.join(self.directory, "case")
        report = os.path.join(EXAMPLES, "flow_report.py")
        self.refused(run("pvpython", report, "junction", case), "There is no file .*log.simpleFoam")
        rows = {"flow_inlet": "-2", "flow_outlet1": "1", "flow_outlet2": "0.5", "flow_outlet3": "0.49",
                "pressure_inlet": "0.5"}
        for name, value in rows.items():
            self.write(os.path.join(case, "postProcessing", name, "0", "surfaceFieldValue.dat"), f"# Time\n7 {value}\n")
        self.write(os.path.join(case, "postProcessing", "yPlus", "0", "yPlus.dat"), "# Time\n7 wall 0.1 3 1\n")
        log = "\nTime = 7\nSolving for Ux, Initial residual = 2e-6, x\nSolving for Uy, Initial residual = 4e-6, x\n" \
              "Solving for p, Initial residual = 9e-5, x\nSolving for p, Initial residual = 1e-9, x\nExecutionTime = 3.2 s\n"
        self.write(os.path.join(case, "log.simpleFoam"), log)
        self.refused(run("pvpython", report, "junction", case), "not converged")
        self.write(os.path.join(case, "log.simpleFoam"), log + "SIMPLE solution converged in 7 iterations\n")
        done = run("pvpython", report, "junction", case)
        self.refused(done, r"differ by 0\.50%")
        self.assertIn("U 4.0e-06, p 9.0e-05", done.stdout)
        self.assertIn("0.6000 Pa", done.stdout)
        self.write(os.path.join(case, "postProcessing", "flow_outlet3", "0", "surfaceFieldValue.dat"), "7 0.5001\n")
        self.assertEqual(run("pvpython", report, "junction", case).returncode, 0)

    def write(self, path, text):
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="ascii") as file:
            file.write(text)

    @unittest.skipUnless(shutil.which("simpleFoam"), "OpenFOAM is not installed")
    def test_flow_through_a_coarse_junction(self):
        done = run(os.path.join(EXAMPLES, "junction_flow.sh"), self.out, COARSE, MESHER=self.mesher)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        figures = dict(re.findall(r"^([a-z][\w ,+-]*?)  +(\S.*)$", done.stdout, re.M))
        self.assertLess(int(figures["iterations"]), 1500)
        # 1 m/s through the inlet, a circle of 40 mm; what an inscribed polygon of cells may miss is well below 5%
        self.assertAlmostEqual(float(figures["flow in"].split()[0]) / (3.14159 * 0.02**2), 1, delta=0.05)
        self.assertAlmostEqual(float(figures["in - out, relative"]), 0, delta=1e-3)
        self.assertGreater(float(figures["pressure drop"].split()[0]), 0)
        for name in ("velocity.png", "pressure.png"):
            self.assertGreater(os.path.getsize(os.path.join(self.out, name)), 10000)

    @unittest.skipUnless(shutil.which("potentialFoam"), "OpenFOAM is not installed")
    def test_flow_around_a_sphere(self):
        """Potential flow around a sphere is known: 1.5 sin(angle) times the free speed on its surface."""
        sphere, writer = vtkSphereSource(), vtkSTLWriter()
        sphere.SetCenter(*MIDDLE)
        sphere.SetRadius(RADIUS)
        sphere.SetThetaResolution(64)
        sphere.SetPhiResolution(64)
        geometry = os.path.join(self.directory, "sphere.stl")
        writer.SetInputConnection(sphere.GetOutputPort())
        writer.SetFileName(geometry)
        writer.Write()
        done = run(os.path.join(EXAMPLES, "motorbike_potential.sh"), self.out, 1 / 16, geometry, MESHER=self.mesher)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertGreater(os.path.getsize(os.path.join(self.out, "flow.png")), 10000)
        patches = flow_pictures.read_case(os.path.join(self.out, "case"))[1]
        wall = flow_pictures.joined(flow_pictures.body_patches(patches))
        from_middle = vtk_to_numpy(wall.GetPoints().GetData()) - MIDDLE
        sine = np.hypot(from_middle[:, 1], from_middle[:, 2]) / np.linalg.norm(from_middle, axis=1)
        speed = np.linalg.norm(flow_pictures.at_points(wall, "grad(Phi)"), axis=1) / flow_pictures.FREE_SPEED
        self.assertGreater(len(speed), 1000)
        self.assertLess(np.sqrt(np.mean((speed - 1.5 * sine)**2)), 0.06)  # cells of an eighth of the radius
        self.assertAlmostEqual(speed[sine > 0.995].mean(), 1.5, delta=0.06)


if __name__ == "__main__":
    unittest.main()
