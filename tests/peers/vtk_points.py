#!/usr/bin/env python3
"""Times VTK drawing the vertices of a PLY file, as the peer that Pointstage's renderers are measured against.

Two mappers, at 800x580 unless told otherwise:
  points    vtkPolyDataMapper on vertex cells, one pixel a point, lit by the file's normals where it has them
  gaussian  vtkPointGaussianMapper with its opaque splat shader, radius from the spacing of the vertices

Each frame turns the camera a little, so that nothing can be taken from the frame before, renders, and reads one pixel
back, so that the drawing is done when the clock stops. The median over the frames is printed as JSON on standard
output. Positions, normals and colours are in VTK's own buffers before the clock starts.

`cargo xtask bench draw` runs it beside Pointstage. How to run it alone, with VTK in an environment of its own and Mesa's
software OpenGL on a virtual display:

    python3 -m venv /tmp/vtk && /tmp/vtk/bin/pip install vtk
    xvfb-run -a -s '-screen 0 1280x1024x24' env LIBGL_ALWAYS_SOFTWARE=1 \\
        /tmp/vtk/bin/python tests/peers/vtk_points.py FILE.ply
"""

import argparse
import json
import math
import statistics
import sys
import time

import vtk

SPLAT_SHADER = """
//VTK::Color::Impl
float dist = dot(offsetVCVSOutput.xy, offsetVCVSOutput.xy);
if (dist > 1.0) { discard; }
"""


def read_vertices(path):
    """The file's vertices as poly data with one vertex cell each; faces are dropped."""
    reader = vtk.vtkPLYReader()
    reader.SetFileName(path)
    reader.Update()
    mesh = reader.GetOutput()
    count = mesh.GetNumberOfPoints()
    if count == 0:
        sys.exit(f"{path}: VTK read no vertices")
    cells = vtk.vtkCellArray()
    cells.InsertNextCell(count)
    for index in range(count):
        cells.InsertCellPoint(index)
    vertices = vtk.vtkPolyData()
    vertices.SetPoints(mesh.GetPoints())
    vertices.SetVerts(cells)
    vertices.GetPointData().ShallowCopy(mesh.GetPointData())
    return vertices


def splat_radius(vertices):
    """Radius at which disks just cover a surface whose vertices form a regular triangular net.

    That is spacing / sqrt(3); the spacing is the median, over a thousand vertices, of the mean distance to the six
    nearest others. Pointstage's disks on a regular mesh have the same radius.
    """
    locator = vtk.vtkStaticPointLocator()
    locator.SetDataSet(vertices)
    locator.BuildLocator()
    nearest = vtk.vtkIdList()
    count = vertices.GetNumberOfPoints()
    means = []
    for index in range(0, count, max(1, count // 1000)):
        centre = vertices.GetPoint(index)
        locator.FindClosestNPoints(7, centre, nearest)
        others = [vertices.GetPoint(nearest.GetId(rank)) for rank in range(1, nearest.GetNumberOfIds())]
        if others:
            means.append(statistics.fmean(math.dist(centre, other) for other in others))
    return statistics.median(means) / math.sqrt(3.0) if means else 1.0


def make_mapper(kind, vertices):
    """The mapper called `kind`, ready to draw."""
    if kind == "points":
        mapper = vtk.vtkPolyDataMapper()
        mapper.SetInputData(vertices)
        return mapper
    mapper = vtk.vtkPointGaussianMapper()
    mapper.SetInputData(vertices)
    mapper.SetScaleFactor(splat_radius(vertices))
    mapper.EmissiveOff()
    mapper.SetSplatShaderCode(SPLAT_SHADER)
    # The triangle that carries the disk just encloses it; the default, three times larger, would only be discarded.
    mapper.SetBoundScale(1.0)
    return mapper


def measure(kind, vertices, size, frames, warm_up, picture):
    """Milliseconds of each of `frames` frames."""
    actor = vtk.vtkActor()
    actor.SetMapper(make_mapper(kind, vertices))
    actor.GetProperty().SetOpacity(1.0)
    renderer = vtk.vtkRenderer()
    renderer.AddActor(actor)
    window = vtk.vtkRenderWindow()
    window.SetMultiSamples(0)
    window.SetSize(*size)
    window.AddRenderer(renderer)
    renderer.ResetCamera()
    pixel = vtk.vtkUnsignedCharArray()
    times = []
    for frame in range(warm_up + frames):
        renderer.GetActiveCamera().Azimuth(0.25)
        start = time.perf_counter()
        window.Render()
        window.GetPixelData(0, 0, 0, 0, 0, pixel, 0)
        if frame >= warm_up:
            times.append((time.perf_counter() - start) * 1000.0)
    driver = [line.split(":", 1)[1].strip() for line in window.ReportCapabilities().splitlines() if "renderer string" in line]
    if picture:
        grab = vtk.vtkWindowToImageFilter()
        grab.SetInput(window)
        writer = vtk.vtkPNGWriter()
        writer.SetFileName(f"{picture}_{kind}.png")
        writer.SetInputConnection(grab.GetOutputPort())
        writer.Write()
    window.Finalize()
    return times, driver[0] if driver else "unknown"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--size", default="800x580", help="WxH, pixels")
    parser.add_argument("--frames", type=int, default=24)
    parser.add_argument("--warm-up", type=int, default=3, help="frames drawn first and not counted")
    parser.add_argument("--mapper", choices=["points", "gaussian"], action="append", help="both when left out")
    parser.add_argument("--picture", help="also write PICTURE_<mapper>.png")
    arguments = parser.parse_args()
    size = tuple(int(part) for part in arguments.size.split("x"))

    vertices = read_vertices(arguments.file)
    count = vertices.GetNumberOfPoints()
    report = {
        "peer": f"VTK {vtk.vtkVersion().GetVTKVersion()}",
        "file": arguments.file,
        "points": count,
        "size": list(size),
        "frames": arguments.frames,
        "mappers": {},
    }
    for kind in arguments.mapper or ["points", "gaussian"]:
        times, report["driver"] = measure(kind, vertices, size, arguments.frames, arguments.warm_up, arguments.picture)
        median = statistics.median(times)
        report["mappers"][kind] = {
            "median_ms": round(median, 2),
            "min_ms": round(min(times), 2),
            "max_ms": round(max(times), 2),
            "times_ms": [round(time, 2) for time in times],
            "points_per_second": round(count / median * 1000.0),
        }
    print(json.dumps(report, indent=2))


if __name__ == "__main__":
    main()
