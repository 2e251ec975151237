# SPDX-License-Identifier: BSD-3-Clause
"""Panels for the pictures of gallery.py and stage_pictures.py: walls under parallel light with thin mesh lines, sections with
layer cells in another colour, and pictures of several panels side by side.

Each panel is drawn at twice its size and made smaller, which gives lines finer than a pixel; walls are darkened where little
light gets in (ambient occlusion), so that depth is seen without shadows. Pictures have at most 256 colours: half of the bytes."""
import itertools
import os

import mesh_pictures as pictures
import numpy as np
from matplotlib import font_manager
from PIL import Image, ImageDraw, ImageFont
from projection_mesher import ProjectionMesherFilters as pm
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPlane
from vtkmodules.vtkFiltersCore import vtkCutter, vtkFeatureEdges
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader
from vtkmodules.vtkRenderingCore import vtkLight, vtkRenderWindow, vtkWindowToImageFilter
from vtkmodules.vtkRenderingOpenGL2 import vtkRenderStepsPass, vtkSSAOPass

WALL = (0.76, 0.80, 0.84)
LIGHTS = (((-0.5, 0.7, 1.0), 0.85), ((0.8, -0.2, 0.6), 0.35))  # where parallel light comes from as seen by the eye; how bright
FINER = 2  # pixels drawn for each of the picture, along each axis
GAP = 6  # pixels between panels
BAND = 32  # pixels of a panel's title
ROOM = 1.05  # what a panel shows over the box it is asked for
X, Y, Z = range(3)
SQUARE = (((1, 0, 0), (0, 0, 1)), ((0, -1, 0), (0, 0, 1)), ((0, 0, 1), (0, 1, 0)))  # to the eye, upwards, for each axis


# ------------------------------------------------------------------------------------------------------- actors
def walls(boundary, outside=False, colours=None):
    """The faces on the geometry; those that look away from the eye are left out, for a thin sheet has two in one place.
    colours: one for each patch, else all are grey."""
    shown = pictures.only_patches(boundary, pictures.shown_patches(boundary))
    names = boundary.GetFieldData().GetAbstractArray("PatchNames").GetNumberOfValues()
    actor = meshed(pictures.actor_of(shown, pictures.lookup(colours or [WALL], names)))
    if outside:
        actor.GetProperty().FrontfaceCullingOn()  # faces look out of the mesh, into the body
    else:
        actor.GetProperty().BackfaceCullingOn()
    return actor


def meshed(actor):
    """The actor with thin mesh lines and a dull surface."""
    look = actor.GetProperty()
    look.EdgeVisibilityOn()
    look.SetEdgeColor(*pictures.LINES)
    look.SetInterpolationToFlat()
    look.SetAmbient(0.28)
    look.SetDiffuse(0.85)
    return actor


def section(grid, axis, position, width=1.3):
    """The cells cut by a plane square to an axis, layer cells in another colour, and the mesh's outline thicker."""
    cut = pictures.cut_grid(grid, axis, position)
    face, lines = pictures.section_actors(cut)
    lines.GetProperty().SetLineWidth(width)
    edges = vtkFeatureEdges()
    edges.SetInputData(cut)
    edges.FeatureEdgesOff()
    edges.ColoringOff()
    edges.Update()
    outline = pictures.actor_of(edges.GetOutput())
    outline.GetProperty().SetColor(*pictures.LINES)
    outline.GetProperty().SetLineWidth(2 * width)
    outline.GetProperty().LightingOff()
    return [face, lines, outline]


def cut_line(surface, axis, position, colour=(0.80, 0.15, 0.10)):
    """Where a plane square to an axis cuts a geometry's triangles."""
    plane, cutter = vtkPlane(), vtkCutter()
    plane.SetNormal(*(1.0 if a == axis else 0.0 for a in range(3)))
    plane.SetOrigin(*(position if a == axis else 0.0 for a in range(3)))
    cutter.SetCutFunction(plane)
    cutter.SetInputData(surface)
    cutter.Update()
    line = pictures.actor_of(cutter.GetOutput())
    line.GetProperty().SetColor(*colour)
    line.GetProperty().SetLineWidth(4)
    line.GetProperty().LightingOff()
    return line


# ------------------------------------------------------------------------------------------------------- panels
class Panel:
    """Part of a picture: what is seen of actors from a direction (towards the eye). box, in VTK's order, is what is shown;
    without one, all. depth: walls, which get light and occlusion over distances of this part of what is shown."""

    def __init__(self, title, actors, eye, up=(0, 0, 1), box=None, depth=0.04):
        self.title, self.actors, self.eye, self.up, self.box, self.depth = title, actors, eye, up, box, depth

    def aim(self, renderer, size):
        """Parallel rays; the shown box fills the panel. Returns its height in the geometry's unit."""
        if self.box:
            corners = np.array(list(itertools.product(*np.reshape(self.box, (3, 2)))))
        else:
            corners = np.concatenate([vtk_to_numpy(a.GetMapper().GetInput().GetPoints().GetData()) for a in self.actors])
        eye = np.array(self.eye, float) / np.linalg.norm(self.eye)
        right = np.cross(self.up, eye)
        right /= np.linalg.norm(right)
        upwards = np.cross(eye, right)
        along = corners @ np.array((right, upwards, eye)).T
        spans, middle = np.ptp(along, axis=0), 0.5 * (along.min(axis=0) + along.max(axis=0)) @ (right, upwards, eye)
        height = ROOM * max(spans[1], spans[0] * size[1] / size[0])
        camera = renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetFocalPoint(*middle)
        camera.SetPosition(*(middle + eye * np.linalg.norm(np.ptp(corners, axis=0))))
        camera.SetViewUp(*self.up)
        camera.SetParallelScale(height / 2)
        renderer.ResetCameraClippingRange()
        return height

    def image(self, size):
        renderer = pictures.new_renderer(self.actors)
        renderer.AutomaticLightCreationOff()
        for place, intensity in LIGHTS:
            light = vtkLight()
            light.SetLightTypeToCameraLight()
            light.PositionalOff()
            light.SetPosition(*place)
            light.SetFocalPoint(0, 0, 0)
            light.SetIntensity(intensity)
            renderer.AddLight(light)
        height = self.aim(renderer, size)
        if self.depth:
            occlusion = vtkSSAOPass()
            occlusion.SetRadius(self.depth * height)
            occlusion.SetBias(0.01 * self.depth * height)
            occlusion.SetKernelSize(64)
            occlusion.BlurOn()
            occlusion.SetDelegatePass(vtkRenderStepsPass())
            renderer.SetPass(occlusion)
        window = vtkRenderWindow()
        window.SetOffScreenRendering(1)
        window.SetMultiSamples(0 if self.depth else 8)
        window.SetSize(FINER * size[0], FINER * size[1])
        window.AddRenderer(renderer)
        return pixels(window).resize(size, Image.LANCZOS)

    def captioned(self, size):
        """The panel with its title in a band below."""
        sheet = Image.new("RGB", size, tuple(round(255 * c) for c in pictures.BACKGROUND))
        sheet.paste(self.image((size[0], size[1] - BAND)), (0, 0))
        font = ImageFont.truetype(font_manager.findfont("DejaVu Sans"), 16)
        ImageDraw.Draw(sheet).text((10, size[1] - BAND + 6), self.title, font=font, fill=(25, 25, 25))
        return sheet


class Key:
    """A panel of names on their colours, from above downwards."""

    def __init__(self, entries):
        self.entries = entries

    def captioned(self, size):
        sheet = Image.new("RGB", size, tuple(round(255 * c) for c in pictures.BACKGROUND))
        pen, font = ImageDraw.Draw(sheet), ImageFont.truetype(font_manager.findfont("DejaVu Sans"), 15)
        for row, (name, colour) in enumerate(self.entries):
            top = 24 + 40 * row
            pen.rectangle((14, top, 40, top + 26), fill=tuple(round(255 * c) for c in colour), outline=(60, 60, 60))
            pen.text((50, top + 4), name, font=font, fill=(25, 25, 25))
        return sheet


def pixels(window):
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    data = grab.GetOutput()
    wide, high, _ = data.GetDimensions()
    image = Image.fromarray(vtk_to_numpy(data.GetPointData().GetScalars()).reshape(high, wide, 3)[::-1].copy())
    window.Finalize()  # a display has room for few
    return image


def square(title, grid, axis, position, box=None):
    """The section square to an axis, seen from the axis' end."""
    eye, up = SQUARE[axis]
    if box:
        box = [position if i // 2 == axis else side for i, side in enumerate(box)]
    return Panel(title, section(grid, axis, position), eye, up, box, depth=0)


def fewer_colours(path, colours=256):
    """Writes a picture again in a third of the bytes."""
    Image.open(path).convert("RGB").quantize(colours, dither=Image.Dither.NONE).save(path, optimize=True)


def draw(rows, path, width=1200, colours=256):
    """A picture of rows of panels. A row is (height in pixels, panels, their parts of the width). colours: how many, 0 = all, where
    small things in colours of their own count."""
    images, y = [], 0
    for height, panels, parts in rows:
        room, x = width - GAP * (len(panels) - 1), 0
        for k, (panel, part) in enumerate(zip(panels, parts)):
            right = width if k == len(panels) - 1 else x + round(room * part / sum(parts))
            images.append((panel.captioned((right - x, height)), (x, y)))
            x = right + GAP
        y += height + GAP
    sheet = Image.new("RGB", (width, y - GAP), (255, 255, 255))
    for image, place in images:
        sheet.paste(image, place)
    sheet.save(path, optimize=True)
    if colours:
        fewer_colours(path, colours)


# ------------------------------------------------------------------------------------------------------- meshes
def read_mesh(folder):
    """mesh.vtu, boundary.vtp and, where it is, unresolved.vtp as mesh.sh leaves them in its folder."""
    lost = f"{folder}/unresolved.vtp"
    return (pictures.read(vtkXMLUnstructuredGridReader(), f"{folder}/mesh.vtu"),
            pictures.read(vtkXMLPolyDataReader(), f"{folder}/boundary.vtp"),
            pictures.read(vtkXMLPolyDataReader(), lost) if os.path.exists(lost) else None)


def read_geometry(path):
    reader = pm.vtkSurfaceReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutputDataObject(0)
