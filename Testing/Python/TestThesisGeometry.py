# SPDX-License-Identifier: BSD-3-Clause
"""The thesis' test cases as the generators make them: triangles, closed surfaces, volumes, areas, sharp edges, sizes."""
import unittest

import numpy as np
import thesis_geometry as cases
from vtkmodules.util.numpy_support import vtk_to_numpy


def soup(data):
    points = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
    return points, vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)


def normals(points, triangles):
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return 0.5 * np.cross(b - a, c - a)


def volume(points, triangles):
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def edges(points, triangles):
    """(edges with one triangle, with more than two or two that run the same way, bends of the others in degrees and
    lengths)."""
    n = normals(points, triangles)
    n /= np.linalg.norm(n, axis=1)[:, None]
    ends = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    face = np.tile(np.arange(len(triangles)), 3)
    forward = ends[:, 0] < ends[:, 1]
    key, at, count = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(at.reshape(-1), kind="stable")
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    pairs = first[count == 2]
    one, other = order[pairs], order[pairs + 1]
    bend = np.degrees(np.arccos(np.clip(np.einsum("ij,ij->i", n[face[one]], n[face[other]]), -1, 1)))
    length = np.linalg.norm(points[key[count == 2, 0]] - points[key[count == 2, 1]], axis=1)
    return int((count == 1).sum()), int((count > 2).sum() + (forward[one] == forward[other]).sum()), bend, length


def turned_volume(profile, count):
    """Of a profile of (radius, height) turned about its axis in `count` flat segments, by frusta."""
    r, z = np.asarray(profile).T
    per_square = 0.5 * count * np.sin(2 * np.pi / count)
    return per_square * np.sum(np.diff(z) * (r[1:] ** 2 + r[1:] * r[:-1] + r[:-1] ** 2) / 3)


class ThesisGeometry(unittest.TestCase):
    def assert_closed(self, points, triangles):
        opened, wrong, bend, length = edges(points, triangles)
        self.assertEqual((opened, wrong), (0, 0))
        return bend, length

    def test_piston_bowl(self):
        points, triangles = soup(cases.piston_bowl())
        self.assertEqual(len(triangles), 26352)
        bend, length = self.assert_closed(points, triangles)
        profile = cases.bowl_profile()
        outline = 2 * np.linalg.norm(np.diff(profile, axis=0), axis=1).sum()  # the rim of the plane of symmetry
        rings = 0.5 * np.pi * (2 * cases.BORE + cases.BOWL)  # the bowl's rim, and the cylinder's two
        self.assertAlmostEqual(length[bend > 30].sum(), rings + outline, delta=1e-3 * rings)
        self.assertLess(bend[bend <= 30].max(), 20)
        expected = 0.5 * turned_volume(profile, 2 * cases.BOWL_SEGMENTS)
        self.assertAlmostEqual(volume(points, triangles), expected, delta=1e-9 * expected)
        np.testing.assert_allclose(points.max(axis=0) - points.min(axis=0), (cases.BORE, cases.BORE / 2, cases.HEIGHT),
                                   rtol=1e-3)

    def test_piston_bowl_turns(self):
        straight, triangles = soup(cases.piston_bowl())
        turned, same = soup(cases.piston_bowl(30))
        self.assertEqual(len(triangles), len(same))
        self.assertAlmostEqual(volume(turned, same), volume(straight, triangles), delta=1e-15)
        middle = turned.mean(axis=0)  # was on the y axis
        self.assertAlmostEqual(np.degrees(np.arctan2(middle[1], middle[0])), 120, places=6)

    def test_inlet_port(self):
        data = cases.inlet_port()
        points, triangles = soup(data)
        self.assertAlmostEqual(len(triangles), 5344, delta=100)
        bend, length = self.assert_closed(points, triangles)
        profile = np.vstack([part for _, part in cases.port_profile()])
        expected = turned_volume(profile, cases.PORT_SEGMENTS)
        self.assertAlmostEqual(volume(points, triangles), expected, delta=1e-9 * expected)
        # Rims: outlet, cylinder's head, seat twice, inlet's two, valve's two.
        rims = np.pi * (2 * cases.CYLINDER + cases.VALVE + 2 * cases.PORT + cases.STEM + 2 * cases.VALVE)
        self.assertAlmostEqual(length[bend > 30].sum(), rims, delta=2e-3 * rims)
        np.testing.assert_allclose(points.max(axis=0) - points.min(axis=0),
                                   (cases.CYLINDER, cases.LENGTH, cases.CYLINDER), rtol=2e-3)

    def test_half_of_the_inlet_port(self):
        whole, data = cases.inlet_port(), cases.inlet_port(half=True)
        points, triangles = soup(data)
        self.assertAlmostEqual(len(triangles), 2782, delta=100)
        self.assert_closed(points, triangles)
        expected = 0.5 * volume(*soup(whole))
        self.assertAlmostEqual(volume(points, triangles), expected, delta=1e-9 * expected)
        self.assertLess(points[:, 2].max(), 1e-12)
        patch = vtk_to_numpy(data.GetCellData().GetArray("PatchId"))
        area = np.linalg.norm(normals(points, triangles), axis=1)
        r, z = np.vstack([part for _, part in cases.port_profile()]).T
        self.assertAlmostEqual(area[patch == 3].sum(), 2 * np.sum(np.diff(z) * (r[1:] + r[:-1]) / 2), places=12)
        per_patch = [area[patch == k].sum() for k in range(3)]
        area = np.linalg.norm(normals(*soup(whole)), axis=1)
        patch = vtk_to_numpy(whole.GetCellData().GetArray("PatchId"))
        np.testing.assert_allclose(per_patch, [0.5 * area[patch == k].sum() for k in range(3)], rtol=1e-9)

    def test_separating_models(self):
        data = cases.separating_models()
        points, triangles = soup(data)
        self.assertEqual(len(triangles), 888)
        opened, wrong, _, _ = edges(points, triangles)
        self.assertEqual((opened, wrong), (2 * cases.BODY_SEGMENTS, 0))  # the two noses
        patch = vtk_to_numpy(data.GetCellData().GetArray("PatchId"))
        first, second = (points[np.unique(triangles[patch == k])] for k in (0, 1))
        self.assertAlmostEqual(np.ptp(first[:, 0]), cases.MODEL_LENGTH + cases.NOSE_GAP, delta=0.02)
        self.assertAlmostEqual(np.ptp(second[:, 0]) / np.ptp(first[:, 0]), cases.SECOND_LENGTH / cases.MODEL_LENGTH)
        low, high = np.reshape(cases.SEPARATING_DOMAIN, (3, 2)).T
        self.assertTrue(((points > low) & (points < high)).all())

    def test_parts_of_a_model_are_closed_but_for_the_nose(self):
        for index, (place, triangles) in enumerate(cases.one_model()):
            opened, wrong, bend, _ = edges(place, triangles)
            self.assertEqual((opened, wrong), (cases.BODY_SEGMENTS if index == 1 else 0, 0))
            self.assertGreater(volume(place - place.mean(axis=0), triangles), 0)
            flat = bend < 5  # between facets and inside a plane; every other edge is meant
            self.assertLess(bend[flat].max(initial=0), 4.8)
            self.assertGreater(bend[~flat].min(initial=90), 5.2)


if __name__ == "__main__":
    unittest.main()
