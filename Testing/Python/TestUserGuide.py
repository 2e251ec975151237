# SPDX-License-Identifier: BSD-3-Clause
"""What the pages tell a user to type: each mesh.sh command's options are known, and the guide's script makes its files."""
import glob
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
sys.path.append(os.path.join(ROOT, "Docs", "Examples"))
import mesh  # noqa: E402  the driver that mesh.sh runs; only now can it be found


def read(*path):
    with open(os.path.join(ROOT, *path), encoding="utf-8") as file:
        return file.read()


def commands():
    """(page, words after ./mesh.sh) of each command that stands on a line of its own or between backquotes."""
    for path in [os.path.join(ROOT, "README.md")] + sorted(glob.glob(os.path.join(ROOT, "Docs", "*.md"))):
        text = read(path).replace("\\\n", " ")
        for line in re.findall(r"^(?: {4})?\./mesh\.sh\b(.*)$", text, re.M) + re.findall(r"`\./mesh\.sh ([^`]+)`", text):
            yield os.path.basename(path), shlex.split(line, comments=True)


class UserGuide(unittest.TestCase):
    def test_every_command_has_known_options(self):
        tried = 0
        for page, words in commands():
            if "--help" in words:
                continue
            with self.subTest(page=page, words=words):
                options = mesh.parser().parse_intermixed_args(words)
                options.geometry = []  # the user's own
                mesh.check_options(options)
                tried += 1
        self.assertGreater(tried, 25)

    def test_every_option_is_told(self):
        """In the guide or in the readme."""
        text = read("README.md") + read("Docs", "UserGuide.md")
        names = {name for action in mesh.parser()._actions for name in action.option_strings if name.startswith("--")}
        self.assertEqual({name for name in names if name not in text}, {"--output"})  # told as -o

    def test_pictures(self):
        """Those that need no mesh of the user's: one of a stage, one of the gallery."""
        if not shutil.which("xvfb-run"):
            self.skipTest("pictures need xvfb-run")
        with tempfile.TemporaryDirectory() as folder:
            for script, words, picture in (("stage_pictures.py", [folder, "PaintFront"], "PaintFront.png"),
                                           ("gallery.py", ["no meshes", folder, "aerofoil"], "gallery_aerofoil.png")):
                done = subprocess.run(["xvfb-run", "-a", "pvpython", os.path.join(ROOT, "Docs", "Examples", script), *words],
                                      capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 0, done.stderr)
                with open(os.path.join(folder, picture), "rb") as drawn, \
                        open(os.path.join(ROOT, "Docs", "Images", picture), "rb") as shown:
                    self.assertEqual(drawn.read(24), shown.read(24))  # a PNG of the same width and height

    def test_script(self):
        code, = re.findall(r"^```python\n(.*?)^```", read("Docs", "UserGuide.md"), re.M | re.S)
        built = "build/lib/paraview/plugins/ProjectionMesher/ProjectionMesher.so"
        self.assertIn(built, code)
        with tempfile.TemporaryDirectory() as folder:
            os.symlink(os.path.join(ROOT, "Testing"), os.path.join(folder, "Testing"))
            script = os.path.join(folder, "script.py")
            with open(script, "w", encoding="utf-8") as file:
                file.write(code.replace(built, os.environ["PROJECTIONMESHER_PLUGIN"]))
            done = subprocess.run(["pvpython", script], cwd=folder, capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertNotIn("ERR|", done.stderr)
            for name in re.findall(r'SaveData\("([^"]+)"', code) + ["constant/polyMesh/faces"]:
                path = os.path.join(folder, name)
                if not name.endswith(".foam"):
                    self.assertGreater(os.path.getsize(path), 200, name)
            with open(os.path.join(folder, "layers.csv"), encoding="ascii") as file:
                self.assertRegex(file.read(), r'"all walls",\d+')


if __name__ == "__main__":
    unittest.main()
