# SPDX-License-Identifier: BSD-3-Clause
"""The driver that meshes a folder of models: a line for each run, nothing run twice, and tables that say what the lines say."""
import gzip
import json
import os
import shutil
import subprocess
import tempfile
import unittest

ROOT = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
DRIVER = os.path.join(ROOT, "Testing", "Benchmark", "collection.py")
CLEAN = os.path.join(ROOT, "Testing", "Data", "pipe_junction.stl")
SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"
PAGE = "\n".join(f"<!-- table {name} -->\n<!-- end {name} -->" for name in ("summary", "failures", "1/25")) + "\nend\n"


def collection(*arguments):
    done = subprocess.run(["pvpython", DRIVER, *map(str, arguments)], capture_output=True, text=True, timeout=280, check=False)
    if done.returncode != 0:
        raise AssertionError(done.stdout + done.stderr)
    return done.stdout.strip().splitlines()


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


class Collection(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.mkdtemp()
        self.models, self.results = (os.path.join(self.directory, name) for name in ("models", "results.jsonl"))
        os.mkdir(self.models)

    def tearDown(self):
        shutil.rmtree(self.directory)

    def add(self, name, content):
        with gzip.open(os.path.join(self.models, name), "wt", encoding="ascii") as file:
            file.write(content)

    def entries(self):
        return {(e["model"], e["region"]): e for e in map(json.loads, read(self.results).splitlines())}

    def test_runs_are_lines_and_lines_are_tables(self):
        self.add("pipe.stl.gz", read(CLEAN))
        self.add("square.obj.gz", SQUARE)
        kept = os.path.join(self.directory, "kept")
        run = ("run", self.models, self.results, "--divisions", 25, "--keep", kept)
        self.assertEqual(len(collection(*run)), 4)
        entries = self.entries()
        inside, outside = (entries["pipe.stl.gz", region] for region in ("inside", "outside"))
        for mesh in (inside, outside):
            self.assertEqual(mesh["status"], "mesh")
            self.assertGreater(mesh["cells"], 500)
            self.assertEqual(mesh["layered"], mesh["wall_faces"])
            self.assertGreater(min(mesh["near"], mesh["wall"]), 0.85)
            self.assertLessEqual(mesh["finest"], 1.001 * mesh["diagonal"] / 25)
            self.assertEqual(mesh["quality"]["AngleInternal"]["Outside"], 0)
        self.assertEqual(sorted(os.listdir(kept)), ["pipe_stl_gz_25_0_inside", "pipe_stl_gz_25_0_outside",
                                                    "square_obj_gz_25_0_outside"])
        self.assertEqual(entries["square.obj.gz", "inside"]["status"], "sentence")
        self.assertIn("encloses nothing", entries["square.obj.gz", "inside"]["text"])
        before = read(self.results)
        self.assertEqual(collection(*run), [])  # all there
        self.assertEqual(read(self.results), before)
        self.check_tables(inside, outside)

    def check_tables(self, inside, outside):
        page = os.path.join(self.directory, "page.md")
        with open(page, "w", encoding="utf-8") as file:
            file.write(PAGE)
        collection("table", self.results, page)
        text = read(page)
        self.assertIn(f"| pipe.stl | {inside['cells']:,} / {outside['cells']:,} |", text)
        self.assertIn("| square.obj | nothing enclosed / ", text)
        self.assertIn("| sentences | 1 nothing enclosed | 0 |", text)
        self.assertIn("<!-- table failures -->\nNone.\n<!-- end failures -->", text)
        self.assertTrue(text.endswith("\nend\n"))
        collection("table", self.results, page)
        self.assertEqual(read(page), text)

    def test_a_run_without_end_is_a_result(self):
        self.add("pipe.stl.gz", read(CLEAN))
        collection("run", self.models, self.results, "--divisions", 25, "--timeout", 0.01)
        self.assertEqual({e["status"] for e in self.entries().values()}, {"hang"})


if __name__ == "__main__":
    unittest.main()
