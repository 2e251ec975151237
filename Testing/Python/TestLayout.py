# SPDX-License-Identifier: BSD-3-Clause
"""The layout of the sources: five places a filter, short files and functions, nothing unfinished, no machine's paths;
and of the documents: no dead link, no picture that is missing or that no page shows."""
import ast
import os
import re
import unittest

import server_manager

ROOT = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
STAGES = ("OctreeDecompose", "PaintFront", "DummyLayer", "Project", "ResolveFeatures", "BoundaryRefine")
PLACES = ("Filters/Core/{}.h", "Filters/Core/{}.cxx", "Filters/vtk{}.h", "Filters/vtk{}.cxx", "XML/{}.xml",
          "Testing/Cxx/Test{}.cxx", "Testing/Python/Test{}.py", "Docs/{}.md")
FOLDERS = ("Filters", "Plugin", "XML", "Testing", "Docs", ".ci")
ENDINGS = (".h", ".cxx", ".py", ".xml", ".md", ".cmake", ".txt", ".sh", ".plugin", ".module")
LONGEST_FILE = 500
LONGEST_FUNCTION = 60
# Spelt so that this file does not hold the words itself.
UNFINISHED = re.compile(r"\b(TO" + r"DO|FIX" + r"ME|X" + r"XX|HA" + r"CK)\b|not (yet )?impl" + r"emented")
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
NAMED_FILE = re.compile(r"(?<![\w/])((?:Docs|Testing|Filters|XML|Plugin|\.ci)/[\w./]*\w\.(?:py|sh|md|png|stl|xml|cxx|h))\b")
MACHINE_PATHS = re.compile(r"(?<![\w.}])/(ro" + r"ot|ho" + r"me|wo" + r"rk|tm" + r"p)/\w")


def sources():
    """Paths of all text files of the project, relative to its root."""
    found = [name for name in sorted(os.listdir(ROOT)) if name.endswith(ENDINGS)]
    for folder in FOLDERS:
        for where, folders, names in os.walk(os.path.join(ROOT, folder)):
            folders[:] = sorted(f for f in folders if f != "__pycache__")
            found += [os.path.relpath(os.path.join(where, name), ROOT) for name in sorted(names)
                      if name.endswith(ENDINGS) or "." not in name]
    return found


def read(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        return file.read()


def pages():
    """Paths of the documents, relative to the root."""
    return [path for path in sources() if path.endswith(".md")]


def prose(text):
    """A page without its blocks of code."""
    return re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)


def links(page):
    """(path relative to the root, heading or "") of each link of a page that leads into the project."""
    for target in LINK.findall(prose(read(page))):
        if "://" not in target:
            path, _, heading = target.partition("#")
            yield os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page, heading


def headings(page):
    """The names by which links find a page's headings."""
    found = re.findall(r"^#+ (.+)$", prose(read(page)), re.M)
    return {re.sub(r"[^\w\- ]", "", re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)).lower().replace(" ", "-") for text in found}


def cxx_functions(text):
    """(name line, lines of the body) of functions that start in the first column."""
    start = None
    for number, line in enumerate(text.splitlines(), 1):
        if re.match(r"[A-Za-z~].*\{$", line) and not re.match(r"(namespace|class|struct|enum|union|extern)\b", line):
            start = number
        elif line.startswith("    ") and line.rstrip().endswith(") {") and start is None:
            start = number  # a signature that runs over two lines
        elif line == "}" and start is not None:
            yield start, number - start - 1
            start = None
        elif line.startswith("};"):
            start = None


class Layout(unittest.TestCase):
    def test_every_stage_has_its_places(self):
        missing = [place.format(stage) for stage in STAGES for place in PLACES
                   if not os.path.exists(os.path.join(ROOT, place.format(stage)))]
        self.assertEqual(missing, [])

    def test_every_class_has_its_server_manager_file(self):
        classes = re.findall(r"^ +vtk(\w+)", read("Filters/CMakeLists.txt"), re.M)
        shared = {"MeshStage", "ValidMeshStage", "FoamLimitsStage"}
        self.assertGreaterEqual(set(classes), set(STAGES))
        missing = [f"XML/{name}.xml" for name in classes
                   if name not in shared and not os.path.exists(os.path.join(ROOT, "XML", f"{name}.xml"))]
        self.assertEqual(missing, [])

    def test_every_property_is_on_its_page(self):
        """With its default; the validity limits, which many filters share, stand on the page of Mesh Validity, those
        of the octree, which Projection Mesh inherits, on that of Octree Decompose."""
        limits = read("Docs/MeshValidity.md")
        filters = dict(server_manager.proxies(os.path.join(ROOT, "XML")))
        absent = []
        for stem in STAGES + ("ProjectionMesh", "DetectFeatures", "CloseHoles", "FarField", "ConvertCells", "PlanarMesh",
                              "MeshValidity", "MeshQualityReport", "MeshSlice"):
            page = read(f"Docs/{stem}.md")
            if filters[stem].get("base_proxyname") == "OctreeProperties":
                page += read("Docs/OctreeDecompose.md")
            for element in server_manager.properties(filters[stem]):
                name, default = element.get("name"), element.get("default_values", "")
                row = re.search(rf"^\| `{name}` \| (.*?) \|", page + limits, re.M)
                same = row and (element.tag != "DoubleVectorProperty" or default.startswith("0.333")
                                or element.get("repeat_command") or row.group(1) == default)
                if not same:
                    absent.append(f"{stem}.{name}")
        self.assertEqual(absent, [])

    def test_bases_are_loaded_first(self):
        """ParaView's window aborts when a proxy comes before the one that it inherits from."""
        listed = re.search(r"set\(bases (.*?)\)\n.*PREPEND server_manager_xml \$\{bases\}", read("Plugin/CMakeLists.txt"), re.S)
        bases = {f"{stem}.xml" for _, stem, element in server_manager.definitions(os.path.join(ROOT, "XML"))
                 if element.tag not in server_manager.PROXIES}
        self.assertEqual({os.path.basename(path) for path in listed.group(1).split()}, bases)

    def test_files_are_short(self):
        long = [f"{path}: {lines} lines" for path in sources()
                if (lines := read(path).count("\n")) > LONGEST_FILE]
        self.assertEqual(long, [])

    def test_functions_are_short(self):
        long, counted = [], 0
        for path in sources():
            if path.endswith(".cxx"):
                lengths = list(cxx_functions(read(path)))
            elif path.endswith(".py"):
                lengths = [(node.lineno, node.end_lineno - node.lineno) for node in ast.walk(ast.parse(read(path)))
                           if isinstance(node, ast.FunctionDef)]
            else:
                continue
            counted += len(lengths)
            long += [f"{path}:{line}: {length} lines" for line, length in lengths if length > LONGEST_FUNCTION]
        self.assertGreater(counted, 300)  # the scan sees functions
        self.assertEqual(long, [])

    def test_nothing_is_unfinished(self):
        marked = [f"{path}:{number}: {line.strip()}" for path in sources()
                  for number, line in enumerate(read(path).splitlines(), 1) if UNFINISHED.search(line)]
        self.assertEqual(marked, [])

    def test_no_paths_of_one_machine(self):
        named = [f"{path}:{number}: {line.strip()}" for path in sources()
                 for number, line in enumerate(read(path).splitlines(), 1) if MACHINE_PATHS.search(line)]
        self.assertEqual(named, [])

    def test_links_lead_somewhere(self):
        dead, seen = [], 0
        for page in pages():
            for path, heading in links(page):
                seen += 1
                if not os.path.exists(os.path.join(ROOT, path)) or heading and heading not in headings(path):
                    dead.append(f"{page}: {path}" + (f"#{heading}" if heading else ""))
        self.assertGreater(seen, 100)  # the scan sees links
        self.assertEqual(dead, [])

    def test_named_files_exist(self):
        """Those that a page names with their folder, as its commands do."""
        absent = [f"{page}: {path}" for page in pages() for path in NAMED_FILE.findall(read(page))
                  if not os.path.exists(os.path.join(ROOT, path)) and "Example" not in os.path.basename(path)]
        self.assertEqual(absent, [])

    def test_every_picture_is_shown(self):
        shown = {path for page in pages() for path, _ in links(page)}
        pictures = {f"Docs/Images/{name}" for name in os.listdir(os.path.join(ROOT, "Docs", "Images"))}
        self.assertGreater(len(pictures), 20)
        self.assertEqual(sorted(pictures - shown), [])

    def test_every_page_is_reached_from_the_readme(self):
        reached, ways = set(), ["README.md"]
        while ways:
            page = ways.pop()
            if page not in reached:
                reached.add(page)
                ways += [path for path, _ in links(page) if path.endswith(".md") and os.path.exists(os.path.join(ROOT, path))]
        self.assertEqual(sorted(set(pages()) - reached - {"CHANGELOG.md"}), [])

    def test_licence_line(self):
        without = [path for path in sources() if path.endswith((".h", ".cxx", ".py", ".sh", ".cmake"))
                   and "SPDX-License-Identifier: BSD-3-Clause" not in "\n".join(read(path).splitlines()[:3])]
        self.assertEqual(without, [])

    def test_kernel_knows_nothing_of_vtk(self):
        using = [path for path in sources() if path.startswith("Filters/Core/")
                 and re.search(r"#include [<\"]vtk", read(path))]
        self.assertEqual(using, [])

    def test_only_the_distance_field_uses_openvdb(self):
        using = [path for path in sources() if path.endswith((".h", ".cxx")) and "#include <openvdb" in read(path)]
        self.assertEqual(using, ["Filters/Core/DistanceField.cxx"])


if __name__ == "__main__":
    unittest.main()
