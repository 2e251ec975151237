# SPDX-License-Identifier: BSD-3-Clause
"""Meshes triangle geometry from the command line; ../../mesh.sh builds the suite and runs this.

Runs the chain stage by stage through the VTK classes of ProjectionMesherFilters, with time and memory of each, and
writes mesh.vtu, boundary.vtp, polyMesh/, unresolved.vtp (parts of features without mesh edges), section.png and
surface.png. Exits 0 only when the mesh is valid.
"""
import argparse
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import time

import mesh_report

HERE = os.path.dirname(os.path.abspath(__file__))
EXAMPLE = os.path.join(HERE, "..", "..", "Testing", "Data", "pipe_junction_dirty.stl")
EXAMPLE_FEATURE_SIZE = 0.003
STAGES = ("OctreeDecompose", "PaintFront", "DummyLayer", "Project", "ResolveFeatures", "BoundaryRefine")
SHORT_NAMES = ("octree", "front", "layer", "project", "features", "refine")


class UserError(Exception):
    """What the user must read: one sentence."""


# ---------------------------------------------------------------------------------------------------- options
class Parser(argparse.ArgumentParser):
    def __init__(self, **options):
        super().__init__(**options)
        self._negative_number_matcher = re.compile(r"^-(\d|\.\d|inf|nan)")  # also -1e-3, which argparse forgets

    def error(self, message):
        raise UserError(f"{message[:1].upper()}{message[1:]}; ./mesh.sh --help lists the options.")


def parser():
    p = Parser(prog="./mesh.sh", description="Meshes triangle geometry (STL, OBJ, PLY, VTP, ..., also .gz); without a "
               "geometry, the pipe junction shipped as an example. Lengths are in the geometry's units.")
    p.add_argument("geometry", nargs="*", metavar="GEOMETRY", help="files of triangles; each solid or group is a patch")
    p.add_argument("-o", "--output", default="out", metavar="OUT", help="folder for the results (default: out)")
    p.add_argument("--feature-size", type=float, metavar="L",
                   help="largest size of the smallest cells (default: 1/50 of the geometry's diagonal)")
    p.add_argument("--base-size", type=float, metavar="H", help="size of the largest cells (default: automatic)")
    p.add_argument("--domain", type=float, nargs=6, metavar=("xmin", "ymin", "zmin", "xmax", "ymax", "zmax"),
                   help="box to mesh; its sides become patches")
    p.add_argument("--region", choices=("inside", "outside"),
                   help="default: inside, or outside where a domain is given")
    p.add_argument("--point", type=float, nargs=3, action="append", metavar=("x", "y", "z"),
                   help="mesh the region that holds this point; may be repeated")
    p.add_argument("--keep-out", type=float, nargs=3, action="append", metavar=("x", "y", "z"),
                   help="a point that must not be meshed: reaching it is a leak; may be repeated")
    p.add_argument("--refine-box", type=float, nargs=7, action="append", default=[],
                   metavar=("xmin", "ymin", "zmin", "xmax", "ymax", "zmax", "SIZE"),
                   help="cells in the box are at most SIZE large; may be repeated")
    p.add_argument("--close-holes", choices=("coarse-to-fine", "offset"),
                   help="close the holes that the octree would leak through, in a patch closed_holes; without it a leak "
                   "is an error")
    far = p.add_mutually_exclusive_group()
    far.add_argument("--far-box", type=float, metavar="D",
                     help="put the sides of the domain, but for zmin, this much farther out, on growing cells")
    far.add_argument("--far-sphere", type=float, metavar="R", help="or a sphere of this radius around the domain")
    p.add_argument("--layers", type=int, metavar="N", help="boundary layers (default: 3; 0: keep the one prism)")
    p.add_argument("--first-height", type=float, metavar="H", help="height of the cell at the wall")
    p.add_argument("--expansion", type=float, metavar="R", help="height ratio of neighbouring layers (default: 1.2)")
    p.add_argument("--thickness", type=float, metavar="T", help="height of all layers; with --first-height, the ratio follows")
    p.add_argument("--even-growth", action="store_true", help="divide prisms and the cells behind them anew, so that heights grow evenly into the volume")
    p.add_argument("--y-plus", type=float, metavar="Y", help="y+ of the first cell's centre, for the flow given by --flow")
    p.add_argument("--flow", type=float, nargs=3, metavar=("SPEED", "LENGTH", "VISCOSITY"),
                   help="speed along the wall, length of the wall along it, kinematic viscosity")
    p.add_argument("--patch-layers", nargs=2, action="append", default=[], metavar=("PATCH", "N"),
                   help="N layers (0: none) on patches of this name, in which * stands for any characters; heights as on "
                   "the others; may be repeated")
    p.add_argument("--also", choices=("msh", "stl"), action="append", default=[],
                   help="write mesh.msh for Fluent, or boundary.stl with a solid for each patch, too; may be repeated")
    p.add_argument("--no-pictures", action="store_true", help="do not draw section.png and surface.png")
    p.add_argument("--threads", type=int, default=0, metavar="N", help="threads to use (default: all)")
    p.add_argument("--stop-after", type=stage_index, default=len(STAGES) - 1, metavar="STAGE",
                   help="last stage to run: " + ", ".join(SHORT_NAMES))
    return p


def stage_index(text):
    for names in (SHORT_NAMES, [s.lower() for s in STAGES]):
        if text.lower() in names:
            return names.index(text.lower())
    raise argparse.ArgumentTypeError(f"'{text}' is no stage; the stages are {', '.join(SHORT_NAMES)}")


def check_options(options):
    """What can be said before the geometry is read."""
    numbers = {"--feature-size": options.feature_size, "--base-size": options.base_size,
               "--first-height": options.first_height, "--expansion": options.expansion,
               "--far-box": options.far_box, "--far-sphere": options.far_sphere, "--thickness": options.thickness,
               "--y-plus": options.y_plus}
    numbers.update({"Each number of --flow": value for value in options.flow or [] if not value > 0})
    for name, value in numbers.items():
        if value is not None and not (math.isfinite(value) and value > 0):
            raise UserError(f"{name} must be a number larger than zero, not {value:g}.")
    if options.layers is not None and options.layers < 0:
        raise UserError(f"--layers must not be negative, but it is {options.layers}.")
    if options.y_plus and not options.flow:
        raise UserError("--y-plus needs the flow: give --flow SPEED LENGTH VISCOSITY.")
    if options.y_plus and (options.first_height or options.thickness):
        raise UserError("--y-plus says how high the first layer is; give it or lengths, not both.")
    for patch in options.patch_layers:
        if not patch[1].isdigit():
            raise UserError(f"--patch-layers takes a name and a number of layers, but got {patch[0]} {patch[1]}.")
    if options.threads < 0:
        raise UserError(f"--threads must not be negative, but it is {options.threads}.")
    for box in options.refine_box + ([options.domain] if options.domain else []):
        if not all(map(math.isfinite, box)) or any(box[a] >= box[a + 3] for a in range(3)):
            raise UserError("A box needs finite corners, each minimum below its maximum; got " +
                            " ".join(f"{v:g}" for v in box[:6]) + ".")
        if len(box) == 7 and box[6] <= 0:
            raise UserError(f"The cell size of a --refine-box must be larger than zero, not {box[6]:g}.")
    for point in (options.point or []) + (options.keep_out or []):
        if not all(map(math.isfinite, point)):
            raise UserError("The coordinates of a point must be finite numbers.")
    if (options.far_box or options.far_sphere) and not options.domain:
        raise UserError("A far field needs the sides of a --domain to start from.")
    if options.layers == 0 and not options.patch_layers:
        options.stop_after = min(options.stop_after, STAGES.index("ResolveFeatures"))
    for path in options.geometry:
        check_file(path)


def check_file(path):
    if not os.path.exists(path):
        raise UserError(f"There is no file {path}.")
    if os.path.isdir(path):
        raise UserError(f"{path} is a folder; give files of triangles.")
    if os.path.getsize(path) == 0:
        raise UserError(f"The file {path} is empty.")


# ---------------------------------------------------------------------------------------------------- running
class Progress:
    """A bar on standard error: rewritten in place on a terminal, one line a stage elsewhere."""
    WIDTH = 30

    def __init__(self):
        self.live = sys.stderr.isatty()
        self.shown = None

    def show(self, stage, fraction, caption=""):
        percent = int(100 * min(max(fraction, 0.0), 1.0))
        if self.live and (stage, percent, caption) != self.shown:
            self.shown = (stage, percent, caption)
            sys.stderr.write("\r\033[K" + self.line(stage, percent, caption)[:shutil.get_terminal_size().columns - 1])
            sys.stderr.flush()

    def finish(self, stage, note):
        sys.stderr.write(("\r\033[K" if self.live else "") + self.line(stage, 100, note) + "\n")
        sys.stderr.flush()

    def clear(self):
        if self.live and self.shown:
            sys.stderr.write("\r\033[K")

    def line(self, stage, percent, text):
        filled = self.WIDTH * percent // 100
        return f"[{'#' * filled}{'.' * (self.WIDTH - filled)}] {percent:3d}% {stage:16s} {text}"


class Runner:
    """Updates filters one after the other; collects seconds and peak memory, and turns errors into UserError."""

    def __init__(self):
        self.progress = Progress()
        self.measured = []  # (stage, seconds, MB)
        self.stopped = False
        signal.signal(signal.SIGINT, self.stop)
        signal.signal(signal.SIGTERM, self.stop)

    def stop(self, *_):
        self.stopped = True

    @staticmethod
    def collect(algorithm, event):
        """The list that the texts of the event will be in."""
        texts = []

        def observer(_caller, _event, text):
            texts.append(text)
        observer.CallDataType = "string0"
        algorithm.AddObserver(event, observer)
        return texts

    def run(self, stage, algorithm, action=None):
        """Updates algorithm, or calls action in its place (a writer's Write)."""
        errors, warnings = self.collect(algorithm, "ErrorEvent"), self.collect(algorithm, "WarningEvent")

        def on_progress(caller, _event):
            if self.stopped:
                caller.SetAbortExecute(1)
            self.progress.show(stage, caller.GetProgress(), caller.GetProgressText() or "")

        algorithm.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)  # it only says that the filter failed
        algorithm.AddObserver("ProgressEvent", on_progress)
        mesh_report.return_memory()
        mesh_report.reset_peak_memory()
        start = time.perf_counter()
        self.progress.show(stage, 0)
        (action or algorithm.Update)()
        seconds, megabytes = time.perf_counter() - start, mesh_report.peak_memory()
        if self.stopped or errors:
            self.progress.clear()
            raise UserError("Stopped on request." if self.stopped else sentence(errors[0]))
        self.measured.append((stage, seconds, megabytes))
        self.progress.finish(stage, f"{seconds:.2f} s")
        for warning in warnings:
            print(f"mesh.sh: warning: {sentence(warning)}", file=sys.stderr)


def sentence(error):
    """The message alone of an error that VTK has decorated with file, line and object."""
    text = re.sub(r"^.*?\(0x[0-9a-f]+\): ", "", error.strip(), flags=re.S)
    return " ".join(text.split())


def vtk_box(box):
    """xmin ymin zmin xmax ymax zmax in VTK's order."""
    return box[0], box[3], box[1], box[4], box[2], box[5]


def set_octree(octree, options):
    octree.SetFeatureSize(options.feature_size or 0)
    octree.SetBaseSize(options.base_size or 0)
    if options.domain:
        octree.SetUseDomain(True)
        octree.SetDomainBounds(*vtk_box(options.domain))
    for box in options.refine_box:
        octree.AddRefineBox(*vtk_box(box), box[6])


def meshes_outside(options):
    return not options.point and (options.region or ("outside" if options.domain else "inside")) == "outside"


def layers_filter(pm, options):
    refine = pm.vtkBoundaryRefine()
    if options.layers:
        refine.SetLayers(options.layers)
    if options.expansion:
        refine.SetExpansionRatio(options.expansion)
    first, thickness, y_plus = options.first_height or 0, options.thickness or 0, options.y_plus or 0
    refine.SetFirstHeight(first)
    refine.SetTotalThickness(thickness)
    refine.SetYPlus(y_plus)
    refine.SetEvenGrowth(options.even_growth)
    if options.flow:
        refine.SetFlowSpeed(options.flow[0])
        refine.SetFlowLength(options.flow[1])
        refine.SetKinematicViscosity(options.flow[2])
    if options.layers == 0:
        refine.AddPatchLayer("*", 0, refine.GetExpansionRatio(), 0, 0, 0)
    for patch, layers in options.patch_layers:
        given = (first, thickness, y_plus) if int(layers) > 0 else (0, 0, 0)
        refine.AddPatchLayer(patch, int(layers), refine.GetExpansionRatio(), *given)
    return refine


def make_filters(pm, options):
    """The stages' filters in order, with the user's options."""
    octree, front = pm.vtkOctreeDecompose(), pm.vtkPaintFront()
    set_octree(octree, options)
    if options.point:
        front.SetRegionToPoints()
        for point in options.point:
            front.AddSeedPoint(*point)
    elif meshes_outside(options):
        front.SetRegionToOutside()
    for point in options.keep_out or []:
        front.AddKeepOutPoint(*point)
    filters = [octree, front, pm.vtkDummyLayer(), pm.vtkProject(), pm.vtkResolveFeatures(), layers_filter(pm, options)]
    for stage in filters:
        stage.SetThreads(options.threads)
        stage.SetPatchArray("PatchId")  # the reader's: solids and groups, in each of several files
    return filters[:options.stop_after + 1]


def read_geometry(pm, runner, options):
    """One file's surface, or a block for each of several."""
    from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet
    blocks = vtkMultiBlockDataSet()
    for i, path in enumerate(options.geometry):
        reader = pm.vtkSurfaceReader()
        reader.SetFileName(path)
        runner.run("read", reader)
        surface = reader.GetOutputDataObject(0)
        surface.GetPolys().ConvertToSmallestStorage()
        blocks.SetBlock(i, surface)
    return blocks if len(options.geometry) > 1 else blocks.GetBlock(0)


def prepare_geometry(pm, runner, options):
    geometry = read_geometry(pm, runner, options)
    return close_holes(pm, runner, options, geometry) if options.close_holes else geometry


def close_holes(pm, runner, options, geometry):
    """The geometry without its holes; where they were is left in leaks.vtp."""
    holes = pm.vtkCloseHoles()
    set_octree(holes, options)
    for point in options.point or []:
        holes.AddInsidePoint(*point)
    for point in options.keep_out or []:
        (holes.AddInsidePoint if meshes_outside(options) else holes.AddOutsidePoint)(*point)
    holes.SetMethod({"coarse-to-fine": holes.COARSE_TO_FINE, "offset": holes.OFFSET}[options.close_holes])
    holes.SetThreads(options.threads)
    holes.SetPatchArray("PatchId")
    holes.SetInputDataObject(0, geometry)
    runner.run("CloseHoles", holes)
    write_lines(options, "leaks.vtp", holes.GetOutputDataObject(1))
    return holes.GetOutputDataObject(0)


def write_lines(options, name, lines):
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter
    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(os.path.join(options.output, name))
    writer.SetInputDataObject(lines)
    writer.SetDataModeToBinary()
    writer.Write()


def add_far_field(pm, runner, options, mesh):
    far = pm.vtkFarField()
    far.SetExtendZmin(False)
    if options.far_sphere:
        far.SetShape(1)  # a sphere
        far.SetRadius(options.far_sphere)
    else:
        far.SetDistance(options.far_box)
    far.SetThreads(options.threads)
    consume(far, 0, mesh)
    runner.run("FarField", far)
    return outputs(far)


def check_validity(pm, runner, mesh):
    """The filter with its findings, but without its copy of the mesh."""
    validity = pm.vtkMeshValidity()
    validity.SetInputDataObject(mesh)
    runner.run("validity", validity)
    for data in outputs(validity):
        data.Initialize()
    return validity


def print_notes(grid):
    """What a stage found that the user should know."""
    notes = grid.GetFieldData().GetAbstractArray("Notes")
    for i in range(notes.GetNumberOfValues() if notes else 0):
        print(f"mesh.sh: note: {notes.GetValue(i)}", file=sys.stderr)


def consume(algorithm, port, data):
    """Makes data an input that is freed as soon as the filter has read it."""
    algorithm.SetInputDataObject(port, data)
    algorithm.GetInputAlgorithm(port, 0).ReleaseDataFlagOn()


def outputs(stage):
    """Mesh and boundary, which outlive the filter; no boundary for the octree."""
    return stage.GetOutputDataObject(0), stage.GetOutputDataObject(1) if stage.GetNumberOfOutputPorts() > 1 else None


def run_stage(runner, options, name, stage, inputs):
    """inputs: the mesh of the stage before, which is consumed, and the geometry."""
    for port, data in enumerate(inputs[:stage.GetNumberOfInputPorts()]):
        if data.IsA("vtkUnstructuredGrid"):
            consume(stage, port, data)
        else:
            stage.SetInputDataObject(port, data)
    try:
        runner.run(name, stage)
    except UserError as error:
        if name == "PaintFront" and stage.GetOutputDataObject(stage.LEAKS).GetNumberOfCells():
            write_lines(options, "leaks.vtp", stage.GetOutputDataObject(stage.LEAKS))
            raise UserError(f"{error} The ways are in {options.output}/leaks.vtp.") from error
        raise
    if name == "PaintFront":
        print_notes(stage.GetOutputDataObject(0))
    if name == "ResolveFeatures":
        write_lines(options, "unresolved.vtp", stage.GetOutputDataObject(stage.UNRESOLVED))


def mesh_geometry(pm, runner, options, geometry):
    """Runs the stages; the mesh, its boundary (None after the octree), and lines for the report. A stage is freed when
    its mesh is handed on, the geometry after the last stage that looks at it."""
    lines, inputs = [], [geometry]
    del geometry
    filters = make_filters(pm, options)
    prepared = filters[0]  # holds the geometry as all stages search it
    for name in STAGES[:len(filters)]:
        boundary = stage = None
        if name == "BoundaryRefine":
            prepared = None
            inputs.pop()
        stage = filters.pop(0)
        run_stage(runner, options, name, stage, inputs)
        lines += mesh_report.of_stage(name, stage)
        grid, boundary = outputs(stage)
        inputs = [grid] + inputs[-1:]
    return grid, boundary, lines


# ---------------------------------------------------------------------------------------------------- results
def write_results(pm, runner, options, mesh, boundary):
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter
    for writer, data, name in ((vtkXMLUnstructuredGridWriter(), mesh, "mesh.vtu"),
                               (vtkXMLPolyDataWriter(), boundary, "boundary.vtp")):
        if data is None:
            continue
        writer.SetFileName(os.path.join(options.output, name))
        writer.SetInputDataObject(data)
        writer.SetCompressorTypeToLZ4()
        writer.SetDataModeToBinary()  # Debian 12's expat, as patched, makes VTK fail to read appended data
        runner.run(f"write {name}", writer, writer.Write)
    if options.stop_after > 0:
        writer = pm.vtkPolyMeshWriter()
        writer.SetInputDataObject(mesh)
        writer.SetDirectory(os.path.join(options.output, "polyMesh"))
        writer.BinaryOff()
        runner.run("write polyMesh", writer, writer.Write)
        others = {"msh": (pm.vtkFluentWriter(), mesh, "mesh.msh"), "stl": (pm.vtkSurfaceWriter(), boundary, "boundary.stl")}
        for writer, data, name in (others[kind] for kind in options.also):
            writer.SetInputDataObject(data)
            writer.SetFileName(os.path.join(options.output, name))
            runner.run(f"write {name}", writer, writer.Write)


def make_pictures(options):
    """In a process of its own: whatever a missing display does there, the mesh is safe."""
    python = sys.executable if os.access(sys.executable or "", os.X_OK) else "pvpython"  # which names no file there
    command = [python, os.path.join(HERE, "mesh_pictures.py"), options.output]
    if shutil.which("xvfb-run"):
        command = ["xvfb-run", "-a"] + command
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if done.returncode != 0:
        lines = done.stdout.decode(errors="replace").strip().splitlines()
        print("No pictures could be made: " + (lines[-1] if lines else "the renderer failed."), file=sys.stderr)


def clear_output(options):
    """Results of an earlier run must not be taken for this one's."""
    try:
        os.makedirs(options.output, exist_ok=True)
        for name in ("mesh.vtu", "mesh.msh", "boundary.vtp", "boundary.stl", "leaks.vtp", "unresolved.vtp", "section.png",
                     "surface.png"):
            if os.path.exists(os.path.join(options.output, name)):
                os.remove(os.path.join(options.output, name))
        shutil.rmtree(os.path.join(options.output, "polyMesh"), ignore_errors=True)
    except OSError as error:
        raise UserError(f"The folder {options.output} cannot be written: {error.strerror}.") from error


def main(arguments):
    options = parser().parse_intermixed_args(arguments)
    check_options(options)
    if not options.geometry:
        options.geometry = [EXAMPLE]
        options.feature_size = options.feature_size or EXAMPLE_FEATURE_SIZE
    clear_output(options)
    from projection_mesher import ProjectionMesherFilters as pm
    runner = Runner()
    mesh, boundary, of_stages = mesh_geometry(pm, runner, options, prepare_geometry(pm, runner, options))
    if (options.far_box or options.far_sphere) and options.stop_after > 0:
        mesh, boundary = add_far_field(pm, runner, options, mesh)
    validity = check_validity(pm, runner, mesh) if options.stop_after > 0 else None
    write_results(pm, runner, options, mesh, boundary)
    report = mesh_report.of_mesh(mesh, boundary, validity) + of_stages + mesh_report.of_cost(runner.measured)
    del mesh, boundary
    if not options.no_pictures:
        make_pictures(options)
    print("\n".join(report), flush=True)
    print(f"Results are in {options.output}")
    if validity and validity.GetViolations() > 0:
        raise UserError(f"The mesh is not valid: {sentence(validity.GetDescription())}")


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except UserError as error:
        print(f"mesh.sh: {error}", file=sys.stderr)
        sys.exit(1)
