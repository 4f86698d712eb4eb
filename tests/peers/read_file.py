"""How long other readers take for a file, and in how much memory.

    python read_file.py FILE RUNS [--without NAME ...]

Prints JSON: {name: {"seconds": [...], "peak_bytes": n, "vertices": n, "triangles": n}}. Readers that are not installed are
left out, and so are those that do not know the format. Of those that cannot read the file, or not within a minute, there are no seconds,
and a line on standard error. Each reader has a process of its own; imports and one first load do not count, but where that load takes
longer than 3 s, it is the only one. The peak is the largest resident
size of that process less the one before the loads. trimesh runs with process=False, which is its fastest way.
laspy and pye57 have read when positions, and the colours that there are, stand in arrays.
Install with: pip install numpy trimesh open3d vtk pymeshlab "laspy[lazrs]" pye57; CloudCompare is a program of its own (Debian's package
cloudcompare), started anew for each run, and says itself how long a file took, to a hundredth of a second.
"""

import functools
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time


def trimesh_reader():
    import trimesh

    def read(path):
        mesh = trimesh.load(path, process=False)
        return len(mesh.vertices), len(getattr(mesh, "faces", ()))

    return read


def open3d_reader():
    import open3d

    def read_mesh(path):
        mesh = open3d.io.read_triangle_mesh(path)
        return len(mesh.vertices), len(mesh.triangles)

    def read_points(path):
        cloud = open3d.t.io.read_point_cloud(path)
        return len(cloud.point.positions), 0

    return read_points if FORMAT in ("pcd", "pts", "xyz") else read_mesh


def vtk_reader():
    from vtkmodules import vtkIOGeometry, vtkIOPLY

    reader_of = {
        "glb": "vtkGLTFReader",
        "obj": "vtkOBJReader",
        "off": "vtkOFFReader",
        "pts": "vtkPTSReader",
        "stl": "vtkSTLReader",
        "xyz": "vtkSimplePointsReader",
    }

    def new_reader():
        if FORMAT == "ply":
            return vtkIOPLY.vtkPLYReader()
        if FORMAT == "xyz":
            from vtkmodules.vtkIOLegacy import vtkSimplePointsReader

            return vtkSimplePointsReader()
        return getattr(vtkIOGeometry, reader_of[FORMAT])()

    def counts(data):
        if data.IsA("vtkMultiBlockDataSet"):
            parts = [counts(data.GetBlock(i)) for i in range(data.GetNumberOfBlocks()) if data.GetBlock(i)]
            return sum(points for points, _ in parts), sum(polygons for _, polygons in parts)
        return data.GetNumberOfPoints(), data.GetNumberOfPolys()

    def read(path):
        reader = new_reader()
        reader.SetFileName(path)
        reader.Update()
        return counts(reader.GetOutput())

    return read


def meshlab_reader():
    import pymeshlab

    meshes = pymeshlab.MeshSet()

    def read(path):
        meshes.clear()
        meshes.load_new_mesh(path)
        mesh = meshes.current_mesh()
        return mesh.vertex_number(), mesh.face_number()

    return read


def laspy_reader():
    import laspy
    import numpy

    def read(path):
        points = laspy.read(path)
        positions = numpy.asarray(points.xyz)
        if "red" in points.point_format.dimension_names:
            numpy.stack([points.red, points.green, points.blue])
        return len(positions), 0

    return read


def pye57_reader():
    import pye57

    def read(path):
        file = pye57.E57(path)
        count = 0
        for scan in range(file.scan_count):
            colours = "colorRed" in file.get_header(scan).point_fields
            count += len(file.read_scan(scan, colors=colours, ignore_missing_fields=True)["cartesianX"])
        return count, 0

    return read


READERS = {
    "trimesh": trimesh_reader,
    "Open3D": open3d_reader,
    "VTK": vtk_reader,
    "MeshLab": meshlab_reader,
    "laspy": laspy_reader,
    "pye57": pye57_reader,
}

# What each of them can be asked for.
FORMATS = {
    "trimesh": ("glb", "obj", "off", "ply", "stl", "xyz"),
    "Open3D": ("glb", "obj", "off", "pcd", "ply", "pts", "stl", "xyz"),
    "VTK": ("glb", "obj", "off", "ply", "pts", "stl", "xyz"),
    "MeshLab": ("glb", "obj", "off", "ply", "pts", "stl", "xyz"),
    "laspy": ("las", "laz"),
    "pye57": ("e57",),
    "CloudCompare": ("e57", "las", "laz", "obj", "off", "pcd", "ply", "pts", "stl", "xyz"),
}

# The extension of the file at hand.
FORMAT = sys.argv[1].rsplit(".", 1)[-1].lower() if len(sys.argv) > 1 else ""

# The program's name; it is measured in a way of its own.
CLOUDCOMPARE = "CloudCompare"

# A reader that takes this long runs once: trimesh takes 14 s for the million-vertex brain as text.
SLOW_SECONDS = 3

# A reader that takes this long for a load is stopped: CloudCompare takes minutes for the brain's STL.
GIVEN_UP_SECONDS = 60

# What imports may take beside it.
START_SECONDS = 15

# A reader that cannot read the file.
NOT_READ = {"seconds": [], "peak_bytes": 0, "vertices": 0, "triangles": 0}


def resident_bytes():
    with open("/proc/self/statm") as statm:
        return int(statm.read().split()[1]) * resource.getpagesize()


def measure(name, path, runs):
    read = READERS[name]()
    before = resident_bytes()
    start = time.perf_counter()
    vertices, triangles = read(path)
    first = time.perf_counter() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 - before
    if first > SLOW_SECONDS:
        return {"seconds": [first], "peak_bytes": peak, "vertices": vertices, "triangles": triangles}
    seconds = []
    for _ in range(runs):
        start = time.perf_counter()
        read(path)
        seconds.append(time.perf_counter() - start)
    return {"seconds": seconds, "peak_bytes": peak, "vertices": vertices, "triangles": triangles}


def cloudcompare(path):
    """Seconds that CloudCompare took for a file, and the largest resident size of all its runs so far."""
    command = ["timeout", str(GIVEN_UP_SECONDS), CLOUDCOMPARE, "-SILENT", "-AUTO_SAVE", "OFF", "-O", os.path.abspath(path)]
    with tempfile.TemporaryDirectory() as folder:
        # It writes no result, but might a log.
        run = subprocess.run(
            command, capture_output=True, text=True, cwd=folder, env=os.environ | {"QT_QPA_PLATFORM": "offscreen"}
        )
    found = re.search(r"finished in ([0-9.]+) s", run.stdout)
    if not found:
        sys.exit(f"read nothing in {GIVEN_UP_SECONDS} s")
    counts = re.search(r"mesh with ([0-9]+) faces and ([0-9]+) vertices", run.stdout)
    points = re.search(r"cloud with ([0-9]+) points", run.stdout)
    triangles, vertices = counts.groups() if counts else (0, points[1] if points else 0)
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
    return float(found[1]), peak, int(vertices), int(triangles)


def measure_cloudcompare(path, runs):
    with tempfile.NamedTemporaryFile("w", suffix=".ply") as tiny:
        tiny.write("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n")
        tiny.write("end_header\n0 0 0\n")
        tiny.flush()
        before = cloudcompare(tiny.name)[1]
    results = [cloudcompare(path)]
    if results[0][0] <= SLOW_SECONDS:
        results += [cloudcompare(path) for _ in range(runs - 1)]
    _, peak, vertices, triangles = results[-1]
    return {
        "seconds": [seconds for seconds, *_ in results],
        "peak_bytes": peak - before,
        "vertices": vertices,
        "triangles": triangles,
    }


def measured(name):
    """What a process of its own says of a reader."""
    command = [sys.executable, __file__, *sys.argv[1:3], name]
    try:
        child = subprocess.run(command, capture_output=True, text=True, timeout=GIVEN_UP_SECONDS + START_SECONDS)
    except subprocess.TimeoutExpired:
        print(f"{name}: stopped after {GIVEN_UP_SECONDS} s", file=sys.stderr)
        return NOT_READ
    if child.returncode == 0 and '"vertices": 0' not in child.stdout:
        return json.loads(child.stdout.strip().splitlines()[-1])
    print(f"{name}: {child.stderr.strip()[-300:] or 'read nothing'}", file=sys.stderr)
    return NOT_READ


def main():
    if len(sys.argv) == 4 and sys.argv[3] != "--without":
        of_reader = measure_cloudcompare if sys.argv[3] == CLOUDCOMPARE else functools.partial(measure, sys.argv[3])
        print(json.dumps(of_reader(sys.argv[1], int(sys.argv[2]))))
        return
    without = sys.argv[4:]
    names = [*READERS, *filter(shutil.which, [CLOUDCOMPARE])]
    results = {name: measured(name) for name in names if FORMAT in FORMATS[name] and name not in without}
    print(json.dumps(results))


if __name__ == "__main__":
    main()
