"""Renders meshes that eses-blocks --mesh has written to a picture, without a display.

Several meshes, such as those of --blocks, are drawn together. --apart moves each away from the centre
of all, as in an exploded view. PLY and VTP files with colours (--color) are drawn in them, with the
exact borders of the patches and a legend, other meshes in a fixed colour. --cavities cuts a
molecule and shows its cavities: the closed shells that are around no part of the molecule.

Needs VTK and numpy (Debian: python3-vtk9, python3-numpy). Without a display, it needs xvfb, or VTK from
PyPI with EGL (Debian: libegl1).
"""

import os

from eses_tools import quiet_interrupt  # before the modules that take time to load

import contextlib
import math
import multiprocessing
import pathlib
import secrets
import shutil
import signal
import struct
import subprocess
import tempfile
import traceback

from eses_tools.common import (NAME, Failed, Parser, at_least, between, complete_file,
                               end_with, input_file, require_file, require_kind, require_output)
from eses_tools import measuring

BACKGROUND = (1, 1, 1)
PLAIN = (0.62, 0.71, 0.80)  # for meshes without colours
# The colours of --color patch.
PATCHES = {"convex": (86, 180, 233), "saddle": (240, 228, 66), "concave": (213, 94, 0)}
CAVITY = (0.84, 0.37, 0)
SECTION = (0.93, 0.90, 0.84)  # of --cavities through the molecule
POTENTIAL = "potential"  # name of an array
MAX_LEGEND = 26  # entries; more would not be legible
MARGIN = 0.03  # free part of the picture on each side
LEGEND_WIDTH = 0.14  # part of the picture at the right
MAX_SIZE = 8000  # pixels; OpenGL draws at most 16384, and each pixel is the mean of several
FINER = 2  # each pixel is the mean of a square with this side
OCCLUSION_RADIUS = 12.0  # angstrom
OCCLUSION_BIAS = 0.1  # angstrom
OCCLUSION_SAMPLES = 96
LINE = 0.035  # height of a line of the legend, relative to that of the picture


def write_cookie(path):
    """Writes a file of xauth with a random cookie for any display, which keeps other users out."""
    fields = (b"", b"", b"MIT-MAGIC-COOKIE-1", secrets.token_bytes(16))  # host, display, protocol, cookie
    any_host = 0xFFFF
    path.write_bytes(struct.pack(">H", any_host)
                     + b"".join(struct.pack(">H", len(field)) + field for field in fields))


@contextlib.contextmanager
def display():
    """Provides a display: that of the user, or one in memory (Xvfb), which ends with the script. Without
    Xvfb, VTK draws with EGL, which needs no display, if its build can."""
    if os.environ.get("DISPLAY"):
        yield
        return
    server = shutil.which("Xvfb")
    if not server:
        if not hasattr(import_vtk(), "vtkEGLRenderWindow"):
            raise Failed("there is no display; install xvfb, or VTK from PyPI (pip install vtk)")
        os.environ["VTK_DEFAULT_OPENGL_WINDOW"] = "vtkEGLRenderWindow"
        yield
        return
    reading, writing = os.pipe()
    process = None
    folder = tempfile.TemporaryDirectory(prefix="render-")
    cookie = pathlib.Path(folder.name) / "Xauthority"
    try:
        write_cookie(cookie)
        with measuring.delayed_signals():
            # A session of its own, so that Ctrl-C does not end it before the picture's program.
            # It chooses a free number, and ends by itself if this script is killed.
            process = subprocess.Popen(
                [server, "-displayfd", str(writing), "-terminate", "-nolisten", "tcp", "-auth", str(cookie),
                 "-screen", "0", "1280x1024x24"], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL, pass_fds=[writing], start_new_session=True)
        os.close(writing)
        with open(reading, encoding="ascii") as numbers:
            number = numbers.readline().strip()
        if not number:
            raise Failed(f"{server}: does not start")
        os.environ.update(DISPLAY=f":{number}", XAUTHORITY=str(cookie))
        yield
    finally:
        with measuring.delayed_signals():  # a second one does not end the cleaning
            if process:
                measuring.end_session(process)
            folder.cleanup()


def import_vtk():
    try:
        import vtk
    except ImportError:
        raise Failed("install VTK (Debian: python3-vtk9; pip: vtk)") from None
    vtk.vtkObject.GlobalWarningDisplayOff()
    return vtk


def triangle_mesh(vtk, points, normals, triangles, colors):
    """Returns a mesh of VTK; `colors` are of triangles, or None."""
    import numpy
    from vtk.util import numpy_support
    mesh, place, cells = vtk.vtkPolyData(), vtk.vtkPoints(), vtk.vtkCellArray()
    place.SetData(numpy_support.numpy_to_vtk(numpy.ascontiguousarray(points), deep=True))
    cells.SetData(3, numpy_support.numpy_to_vtkIdTypeArray(
        numpy.ascontiguousarray(triangles, "i8").ravel(), deep=True))
    mesh.SetPoints(place)
    mesh.SetPolys(cells)
    mesh.GetPointData().SetNormals(numpy_support.numpy_to_vtk(numpy.ascontiguousarray(normals),
                                                              deep=True))
    if colors is not None:
        mesh.GetCellData().SetScalars(numpy_support.numpy_to_vtk(
            numpy.ascontiguousarray(colors, "u1"), deep=True))
    return mesh


def component_name(number):
    return f"cavity {number}" if number else "outside"


def legend_of(kinds, colors, groups):
    """Returns a dictionary from name to colour: of the kinds of patches, or of the first of the groups
    that has these colours. Empty if each atom has a colour. A group is the numbers of the vertices,
    or None, and a function that names a number."""
    import numpy
    if (colors == numpy.array(list(PATCHES.values()))[kinds - 1]).all():
        shown = numpy.unique(kinds)
        return {name: color for kind, (name, color) in enumerate(PATCHES.items(), 1)
                if kind in shown}
    for values, name_of in groups:
        if values is None:
            continue
        numbers, first = numpy.unique(values, return_index=True)
        has_these = (colors == colors[first][numpy.searchsorted(numbers, values)]).all()
        if has_these and len(numbers) <= MAX_LEGEND:
            return {name_of(number): tuple(colors[at]) for number, at in zip(numbers, first)}
    return {}


def paint_vertices(mesh, colors):
    import numpy
    from vtk.util import numpy_support
    mesh.GetCellData().SetScalars(None)
    mesh.GetPointData().SetScalars(numpy_support.numpy_to_vtk(
        numpy.ascontiguousarray(colors, "u1"), deep=True))


def add_potential(mesh, values):
    from vtk.util.numpy_support import numpy_to_vtk
    array = numpy_to_vtk(values.copy(), deep=True)
    array.SetName(POTENTIAL)
    mesh.GetPointData().AddArray(array)


def read_mesh(vtk, path, is_cut=True):
    """Returns a mesh of VTK and its legend. If its colours are those of patches or atoms, its triangles
    are cut at their borders, unless `is_cut` is False."""
    from eses_tools import meshes
    mesh = meshes.read_mesh(path)
    colors, potential = mesh.values.get("color"), mesh.values.get("potential")
    parts, legend = (None, {}) if colors is None or potential is not None or not is_cut else cut(mesh)
    if parts:
        return triangle_mesh(vtk, *parts), legend
    made = triangle_mesh(vtk, mesh.points, mesh.normals, mesh.triangles, None)
    if colors is not None:
        paint_vertices(made, colors)
    if potential is not None:
        add_potential(made, potential)
    return made, legend


def cut(mesh):
    """Returns points, normals, triangles and colours of triangles of a mesh that is cut at the borders of
    its colours, or None if these are unknown, and the legend."""
    import numpy
    from eses_tools import patch_borders
    atoms, colors = mesh.values.get("atom"), mesh.values["color"]
    if atoms is None:
        return None, {}
    kinds = mesh.values.get("patch", numpy.full(len(atoms), patch_borders.CONVEX))
    legend = legend_of(kinds, colors, [
        (mesh.values.get("component"), component_name),
        (mesh.values.get("chain"), lambda number: f"chain {mesh.chains[number]}"
         if mesh.chains[number] else "no chain")])
    _, first, atom = numpy.unique(atoms, return_index=True, return_inverse=True)
    if (colors == colors[first][atom]).all():
        points, normals, triangles, owners = patch_borders.cut_by_atom(mesh)
        owners = owners[triangles[:, 0]]
    elif legend.keys() <= PATCHES.keys():
        points, normals, triangles, owners = patch_borders.divide_by_kind(mesh)
    else:
        return None, legend
    return (points, normals, triangles, colors[owners]), legend


def potentials_of(meshes, options):
    """Returns the potentials at the vertices of each mesh: those of --potential or of the file. None
    if a mesh has none."""
    from eses_tools import open_dx
    from vtk.util.numpy_support import vtk_to_numpy
    if not options.potential:
        stored = [mesh.GetPointData().GetArray(POTENTIAL) for mesh in meshes]
        return None if None in stored else list(map(vtk_to_numpy, stored))
    field = open_dx.read_map(options.potential)
    return [open_dx.potential_at(field, vtk_to_numpy(mesh.GetPoints().GetData()),
                                 vtk_to_numpy(mesh.GetPointData().GetNormals()),
                                 options.potential_offset) for mesh in meshes]


def paint_potential(meshes, values, limit):
    """Colours the vertices by the potential and returns the legend."""
    import numpy
    from eses_tools import page
    limit = limit or page.nice_limit(numpy.concatenate(values))
    for mesh, own in zip(meshes, values):
        paint_vertices(mesh, page.potential_colors(own, limit))
    ticks = numpy.linspace(limit, -limit, len(page.DIVERGING))
    return {f"{tick:+g} kT/e" if tick else "0 kT/e": tuple(color)
            for tick, color in zip(ticks, page.potential_colors(ticks, limit))}


def split_cavities(vtk, mesh):
    """Returns the surfaces around the molecule, and the surfaces of its cavities, as two meshes, and
    the number of the shell of each vertex of the second one.

    Normals point out of the molecule, so that a shell around a cavity has a negative volume: the
    sum of det(a, b, c) / 6 over its triangles.
    """
    import numpy
    from vtk.util.numpy_support import vtk_to_numpy
    shells = vtk.vtkPolyDataConnectivityFilter()
    shells.SetInputData(mesh)
    shells.SetExtractionModeToAllRegions()
    shells.ColorRegionsOn()
    shells.Update()
    mesh = shells.GetOutput()
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    normals = vtk_to_numpy(mesh.GetPointData().GetNormals())
    numbers = vtk_to_numpy(mesh.GetPointData().GetArray("RegionId"))
    triangles = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    a, b, c = (points[corner] - points.mean(axis=0) for corner in triangles.T)
    shell = numbers[triangles[:, 0]]
    volumes = numpy.bincount(shell, (a * numpy.cross(b, c)).sum(axis=1)) / 6
    is_cavity = numpy.zeros(len(points), bool)  # vertices without a triangle have no valid number
    is_cavity[triangles[(volumes < 0)[shell]]] = True
    if not is_cavity.any():
        raise Failed("the mesh has no cavities")

    def part(chosen):
        index = numpy.cumsum(chosen) - 1  # of the chosen vertices
        return triangle_mesh(vtk, points[chosen], normals[chosen],
                             index[triangles[chosen[triangles[:, 0]]]], None)

    return part(~is_cavity), part(is_cavity), numbers[is_cavity]


def choose_depth(depths, numbers):
    """Returns the depth at which a plane cuts most shells. `depths` and `numbers` are of the
    vertices: the depth and the number of the shell."""
    import numpy
    _, shell = numpy.unique(numbers, return_inverse=True)
    low, high = numpy.full(shell.max() + 1, numpy.inf), numpy.full(shell.max() + 1, -numpy.inf)
    numpy.minimum.at(low, shell, depths)
    numpy.maximum.at(high, shell, depths)
    middles = (low + high) / 2
    counts = ((low < middles[:, None]) & (middles[:, None] < high)).sum(axis=1)
    return middles[counts.argmax()]


def section_through(vtk, meshes, plane):
    """Returns the part of a plane that is inside closed meshes, without the cavities."""
    whole, outlines, section = vtk.vtkAppendPolyData(), vtk.vtkCutter(), vtk.vtkContourTriangulator()
    for mesh in meshes:
        whole.AddInputData(mesh)
    outlines.SetInputConnection(whole.GetOutputPort())
    outlines.SetCutFunction(plane)
    section.SetInputConnection(outlines.GetOutputPort())
    section.Update()
    section.GetOutput().GetPointData().SetNormals(None)
    return section.GetOutput()


def make_cut_scene(vtk, mesh, direction):
    """Returns a scene of a mesh that is cut where most of its cavities are, and its legend.
    `direction` is that of the view."""
    import numpy
    from vtk.util.numpy_support import vtk_to_numpy
    surface, cavities, numbers = split_cavities(vtk, mesh)
    depth = choose_depth(vtk_to_numpy(cavities.GetPoints().GetData()) @ direction, numbers)
    plane = vtk.vtkPlane()
    plane.SetOrigin(depth * numpy.array(direction))
    plane.SetNormal(direction)
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(BACKGROUND)
    for part, color, is_cut in ((surface, PLAIN, True), (cavities, CAVITY, True),
                                (section_through(vtk, (surface, cavities), plane), SECTION, False)):
        actor = make_actor(vtk, part, (0, 0, 0))
        actor.GetMapper().ScalarVisibilityOff()
        actor.GetProperty().SetColor(color)
        if is_cut:
            actor.GetMapper().AddClippingPlane(plane)
        else:
            actor.GetProperty().LightingOff()
        renderer.AddActor(actor)
    return renderer, {name: tuple(255 * part for part in color)
                      for name, color in (("cavity", CAVITY), ("section", SECTION))}


def center_of(bounds):
    return [(low + high) / 2 for low, high in zip(bounds[::2], bounds[1::2])]


def make_actor(vtk, mesh, offset):
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(mesh)
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.SetPosition(offset)
    appearance = actor.GetProperty()
    appearance.SetColor(PLAIN)
    appearance.SetAmbient(0.15)
    appearance.SetDiffuse(0.85)
    appearance.SetSpecular(0.15)
    appearance.SetSpecularPower(30)
    return actor


def make_scene(vtk, meshes, apart):
    """Returns a scene of all meshes. Each mesh is moved away from the centre of all by `apart`
    times its distance."""
    bounds = [mesh.GetBounds() for mesh in meshes]
    whole = [value for axis in range(3)
             for value in (min(b[2 * axis] for b in bounds), max(b[2 * axis + 1] for b in bounds))]
    middle = center_of(whole)
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(BACKGROUND)
    for mesh, box in zip(meshes, bounds):
        offset = [apart * (c - m) for c, m in zip(center_of(box), middle)]
        renderer.AddActor(make_actor(vtk, mesh, offset))
    return renderer


def aim(camera, options):
    camera.SetPosition(0, -1, 0)
    camera.SetViewUp(0, 0, 1)
    camera.Azimuth(options.azimuth)
    camera.Elevation(options.elevation)
    return camera


def fit(renderer, aspect, room):
    """Moves the camera along its direction so that all points just fit into the picture.

    `room` is the free part at the right. The camera is at the height d above the plane z = 0, and z
    points to it. A point is in the picture if |x - c| <= t (d - z), where t is the tangent of half
    the view angle. On each side one point decides, which gives the smallest d and the best c.
    """
    import numpy
    from vtk.util.numpy_support import vtk_to_numpy
    camera = renderer.GetActiveCamera()
    back = numpy.array(camera.GetDirectionOfProjection()) * -1
    up = numpy.array(camera.GetViewUp())
    right = numpy.cross(up, back)
    right /= numpy.linalg.norm(right)
    up = numpy.cross(back, right)
    actors = renderer.GetActors()
    points = numpy.concatenate([
        vtk_to_numpy(actor.GetMapper().GetInput().GetPoints().GetData()) + actor.GetPosition()
        for actor in (actors.GetItemAsObject(i) for i in range(actors.GetNumberOfItems()))])
    tangent = numpy.tan(numpy.radians(camera.GetViewAngle()) / 2)  # of the height
    depth, focus, distance = points @ back, numpy.zeros(3), 0.0
    for axis, size in ((right, aspect * (1 - 2 * MARGIN - room)), (up, 1 - 2 * MARGIN)):
        along = points @ axis / (tangent * size)
        high, low = (depth + along).max(), (depth - along).max()
        distance = max(distance, (high + low) / 2)
        focus += tangent * size * (high - low) / 2 * axis
    camera.SetFocalPoint(focus)
    camera.SetPosition(focus + distance * back)
    camera.SetViewUp(up)
    camera.SetWindowCenter(room, 0)


def add_legend(vtk, renderer, legend, size):
    """Draws a square and a name for each entry at the upper right."""
    width, height = size
    line = LINE * height
    for number, (name, color) in enumerate(legend.items()):
        color = [float(value) / 255 for value in color]
        y = height * (1 - MARGIN) - (number + 1) * line
        square = vtk.vtkPlaneSource()
        square.SetOrigin(0, 0, 0)
        square.SetPoint1(0.7 * line, 0, 0)
        square.SetPoint2(0, 0.7 * line, 0)
        mapper = vtk.vtkPolyDataMapper2D()
        mapper.SetInputConnection(square.GetOutputPort())
        patch, text = vtk.vtkActor2D(), vtk.vtkTextActor()
        patch.SetMapper(mapper)
        patch.GetProperty().SetColor(color)
        left = width * (1 - LEGEND_WIDTH)
        patch.SetPosition(left, y)
        text.SetInput(name)
        text.SetPosition(left + line, y)
        text.GetTextProperty().SetColor(0, 0, 0)
        text.GetTextProperty().SetFontSize(max(6, round(0.75 * line)))
        renderer.AddViewProp(patch)
        renderer.AddViewProp(text)


def add_occlusion(vtk, renderer):
    """Makes grooves and pockets darker (ambient occlusion)."""
    bounds = renderer.ComputeVisiblePropBounds()
    length = max(high - low for low, high in zip(bounds[::2], bounds[1::2]))
    steps, occlusion = vtk.vtkRenderStepsPass(), vtk.vtkSSAOPass()
    occlusion.SetDelegatePass(steps)
    occlusion.SetRadius(min(OCCLUSION_RADIUS, length / 4))
    occlusion.SetBias(OCCLUSION_BIAS)
    occlusion.SetKernelSize(OCCLUSION_SAMPLES)
    occlusion.BlurOn()
    renderer.SetPass(occlusion)


def picture_of(vtk, renderer, legend, options):
    """Returns the bytes of a PNG file."""
    size = FINER * options.size, FINER * (options.size * 3 // 4)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(*size)
    window.AddRenderer(renderer)
    camera = aim(renderer.GetActiveCamera(), options)
    fit(renderer, size[0] / size[1], LEGEND_WIDTH if legend else 0)
    camera.Zoom(options.zoom)
    renderer.ResetCameraClippingRange()
    add_legend(vtk, renderer, legend, size)
    if not options.flat:
        add_occlusion(vtk, renderer)
    try:
        window.Render()
        return png_of(vtk, window)
    finally:
        window.Finalize()  # before the display ends


def png_of(vtk, window):
    grabber = vtk.vtkWindowToImageFilter()
    grabber.SetInput(window)
    grabber.ReadFrontBufferOff()
    mean = vtk.vtkImageShrink3D()
    mean.SetInputConnection(grabber.GetOutputPort())
    mean.SetShrinkFactors(FINER, FINER, 1)
    mean.AveragingOn()
    writer = vtk.vtkPNGWriter()
    writer.WriteToMemoryOn()
    writer.SetInputConnection(mean.GetOutputPort())
    writer.Write()
    return bytes(memoryview(writer.GetResult()))


def parse():
    parser = Parser(__doc__, lead=3, usage=f"{NAME} [OPTION...] MESH... -o FILE.png",
                    examples=(("1crn.ply -o 1crn.png", "a mesh of eses-blocks --mesh 1crn.ply"),
                              ("1crn.ply --azimuth 120 --size 2400 -o 1crn.png", "from another side"),
                              ("1crn.ply --potential 1crn.dx -o 1crn.png", "its potential")))
    parser.add_argument("meshes", nargs="+", metavar="MESH", type=input_file,
                        help=".ply, .vtp, .obj, .off, .stl, .glb, .vert or .face file")
    parser.add_argument("-o", "--output", required=True, metavar="FILE", type=pathlib.Path,
                        help="PNG file to write; - for standard output")
    parser.add_argument("--size", type=between(4, MAX_SIZE, int), default=1200, metavar="PIXELS",
                        help="width of the picture; the height is three quarters of it (default: 1200, "
                             f"at most {MAX_SIZE})")
    parser.add_argument("--azimuth", type=at_least(-math.inf), default=30, metavar="DEGREES",
                        help="rotation about the vertical axis (default: 30)")
    parser.add_argument("--elevation", type=at_least(-math.inf), default=20, metavar="DEGREES",
                        help="elevation of the camera (default: 20)")
    parser.add_argument("--zoom", type=between(0.01, 100), default=1, metavar="FACTOR",
                        help="magnification, 0.01 to 100; with 1, the default, the meshes just fit")
    parser.add_argument("--no-legend", action="store_true",
                        help="draw no legend of the colours")
    parser.add_argument("--flat", action="store_true",
                        help="draw no ambient occlusion, which makes grooves and pockets darker")
    parser.add_argument("--potential", type=pathlib.Path, metavar="FILE.dx",
                        help="colour by an OpenDX map of the potential in kT/e; also .dx.gz")
    parser.add_argument("--potential-offset", type=at_least(0), default=0.0, metavar="ANGSTROM",
                        help="take the potential at this distance outside of the surface (default: 0)")
    parser.add_argument("--potential-limit", type=at_least(0, is_open=True), metavar="KT/E",
                        help="end of the scale of colours (default: a round number that 2 per cent "
                             "of the vertices exceed)")
    parser.add_argument("--cavities", action="store_true",
                        help="cut one mesh open where most of its cavities are, and show these")
    parser.add_argument("--apart", type=between(-1000, 1000), default=0, metavar="SHARE",
                        help="move meshes apart by this multiple of their distance from the "
                             "centre (default: 0)")
    options = parser.parse_args()
    if options.cavities and (len(options.meshes) > 1 or options.potential):
        parser.error("--cavities needs a single mesh, without --potential")
    require_kind(parser, options.output, "a picture", ".png")
    return options


def main():
    options = parse()
    from eses_tools import meshes
    for path in options.meshes:
        require_file(path)
        if not meshes.is_mesh(path):
            raise Failed(f"{path}: not a {', '.join(meshes.SUFFIXES[:-1])} or {meshes.SUFFIXES[-1]} file")
    require_output(options.output, [*options.meshes, *filter(None, [options.potential])])
    with display():
        picture = draw_apart(options)
    with complete_file(options.output, mode="wb") as target:
        target.write(picture)


def draw_apart(options):
    """Returns the bytes of a PNG file, which another process draws: VTK and Xlib end their process if the display
    ends or the driver fails. That process has no files to remove."""
    context = multiprocessing.get_context("fork")
    receiving, sending = context.Pipe(duplex=False)
    process = None
    with tempfile.TemporaryFile() as log:
        try:
            with measuring.delayed_signals():
                process = context.Process(target=send_picture, args=(options, sending, log.fileno()))
                process.start()
            sending.close()
            try:
                found = receiving.recv()
            except (EOFError, OSError):  # the process has sent nothing, or a part
                process.join()
                log.seek(0)
                raise Failed(message_of_end(process.exitcode, log.read())) from None
        finally:
            if process and process.pid:
                process.kill()
                process.join()
    if isinstance(found, Exception):
        raise found
    return found


def message_of_end(code, log):
    """Returns the message for a process that has ended before its picture was complete."""
    how = signal.Signals(-code).name if code < 0 else f"exit code {code}"
    words = " ".join(log.decode("utf-8", "replace").split())[:300]
    return (f"no picture: VTK ended with {how} on the display {os.environ.get('DISPLAY') or 'of EGL'}"
            f"{words and f' ({words})'}; try again, or check the display")


def send_picture(options, target, log):
    """Sends the bytes of a PNG file, or the exception that prevents it. The texts of libraries go to the file
    `log`."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, signal.SIG_DFL)  # this process leaves nothing
    os.dup2(log, 2)
    try:
        target.send(draw(options))
    except (Failed, OSError) as error:
        target.send(error)
    except Exception:
        target.send(Failed(traceback.format_exc()))


def draw(options):
    """Returns the bytes of a PNG file of the meshes."""
    vtk = import_vtk()
    found = [read_mesh(vtk, path, not options.cavities) for path in options.meshes]
    drawn = [mesh for mesh, _ in found]
    legend = {name: color for _, entries in found for name, color in entries.items()}
    values = potentials_of(drawn, options)
    if values:
        legend = paint_potential(drawn, values, options.potential_limit)
    if options.cavities:
        direction = aim(vtk.vtkCamera(), options).GetDirectionOfProjection()
        scene, legend = make_cut_scene(vtk, drawn[0], direction)
    else:
        scene = make_scene(vtk, drawn, options.apart)
    return picture_of(vtk, scene, {} if options.no_legend else legend, options)


def start():
    end_with(main)
