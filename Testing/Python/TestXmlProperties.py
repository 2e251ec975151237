# SPDX-License-Identifier: BSD-3-Clause
"""Each server-manager property has a setter of its name, the default of its class, and documentation."""
import os
import re
import unittest

import server_manager
from server_manager import properties
from support import pm

FOLDER = os.environ["PROJECTIONMESHER_XML"]


def proxies():
    return server_manager.proxies(FOLDER)


def values_of(element):
    text = element.get("default_values", "")
    if element.tag == "StringVectorProperty":
        return text
    return [float(v) for v in text.split()]


class TestXmlProperties(unittest.TestCase):
    def test_files_are_named_after_proxy_and_class(self):
        self.assertGreaterEqual(len(list(proxies())), 10)
        for stem, proxy in proxies():
            self.assertEqual(proxy.get("name"), stem)
            self.assertEqual(proxy.get("class"), "vtk" + stem)
            self.assertTrue(hasattr(pm, "vtk" + stem), stem)

    def test_a_base_is_used_and_holds_no_class(self):
        used = {(e.get("base_proxygroup"), e.get("base_proxyname")) for _, _, e in server_manager.definitions(FOLDER)}
        for key, stem, element in server_manager.definitions(FOLDER):
            if element.tag == "Proxy":
                self.assertIn(key, used, stem)
                self.assertIsNone(element.get("class"), stem)
            else:
                self.assertIn(element.tag, server_manager.PROXIES, stem)

    def test_each_name_once(self):
        """Also among what is inherited: a property twice is one property that silently wins."""
        for stem, proxy in proxies():
            names = [e.get("name") for e in properties(proxy) + proxy.findall("InputProperty")]
            self.assertEqual(sorted(names), sorted(set(names)), stem)

    def test_setters(self):
        for stem, proxy in proxies():
            algorithm = getattr(pm, proxy.get("class"))()
            for element in properties(proxy):
                name, command = element.get("name"), element.get("command")
                where = f"{stem}.{name}"
                self.assertTrue(hasattr(algorithm, command), where)
                if element.get("repeat_command") == "1":
                    singular = re.sub("(?<=[xh])es$|s$", "", name)
                    self.assertEqual(command, "Add" + singular, where)
                    self.assertEqual(element.get("clean_command"), "Clear" + name, where)
                    self.assertTrue(hasattr(algorithm, "Clear" + name), where)
                else:
                    self.assertEqual(command, "Set" + name, where)

    def test_every_setter_has_a_property(self):
        for stem, proxy in proxies():
            takes_geometry = any(p.get("name") == "Geometry" for p in proxy.findall("InputProperty"))
            own = {element.get("command") for element in properties(proxy) + proxy.findall("ProxyProperty")}
            cls = getattr(pm, proxy.get("class"))
            for base in (c for c in cls.__mro__ if c.__module__.startswith("projection_mesher")):
                for name in vars(base):
                    if re.match("(Set|Add|Clear)[A-Z]", name) and not re.match("SetRegionTo|Clear", name):
                        if stem in ("DummyLayer", "BoundaryRefine", "FarField", "ConvertCells", "PlanarMesh",
                                    "MeshValidity", "MeshQualityReport", "MeshSlice") and name == "SetPatchArray":
                            continue  # takes no geometry
                        self.assertIn(name, own, f"{stem} has no property for {name}")

    def test_defaults(self):
        for stem, proxy in proxies():
            algorithm = getattr(pm, proxy.get("class"))()
            for element in properties(proxy):
                where = f"{stem}.{element.get('name')}"
                if element.get("repeat_command") == "1":
                    self.assertEqual(getattr(algorithm, "GetNumberOf" + element.get("name"))(), 0, where)
                    continue
                value = getattr(algorithm, "Get" + element.get("name"))()
                wanted = values_of(element)
                if element.tag == "StringVectorProperty":
                    self.assertEqual(value or "", wanted, where)
                else:
                    self.assertEqual([float(v) for v in (value if isinstance(value, tuple) else (value,))], wanted, where)

    def test_ranges(self):
        """A value below or above the XML's range is clamped to it by the setter."""
        for stem, proxy in proxies():
            for element in properties(proxy):
                domain = next((d for d in element if d.tag in ("DoubleRangeDomain", "IntRangeDomain")), None)
                if domain is None:
                    continue
                number = float if domain.tag.startswith("Double") else int
                for bound, outside in (("min", -1e9), ("max", 1e9)):
                    if domain.get(bound) is None:
                        continue
                    algorithm = getattr(pm, proxy.get("class"))()
                    getattr(algorithm, element.get("command"))(number(outside))
                    self.assertEqual(getattr(algorithm, "Get" + element.get("name"))(), number(domain.get(bound)),
                                     f"{stem}.{element.get('name')} {bound}")

    def test_labels_give_the_same_name_in_python(self):
        """paraview.simple names a property after its label, without what is no ASCII letter, digit or underscore."""
        for stem, proxy in proxies():
            for element in properties(proxy):
                label = re.sub("[^A-Za-z0-9_]", "", element.get("label"))
                self.assertEqual(label, element.get("name"), stem)

    def test_documentation(self):
        for stem, proxy in proxies():
            for element in [proxy] + properties(proxy) + proxy.findall("InputProperty") + proxy.findall("ProxyProperty"):
                text = " ".join((element.findtext("Documentation") or "").split())
                self.assertGreater(len(text), 20, f"{stem}.{element.get('name')}")

    def test_groups_name_each_property_once(self):
        for stem, proxy in proxies():
            grouped = [p.get("name") for g in proxy.findall("PropertyGroup") for p in g.findall("Property")]
            if grouped:
                self.assertEqual(sorted(grouped), sorted(e.get("name") for e in properties(proxy)), stem)


if __name__ == "__main__":
    unittest.main()
