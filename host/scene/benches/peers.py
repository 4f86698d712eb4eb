"""How long other readers take for a PLY file, and in how much memory.

    python peers.py FILE RUNS

Prints JSON: {name: {"seconds": [...], "peak_bytes": n, "vertices": n, "triangles": n}}. Readers that are not installed are
left out. Each reader has a process of its own; imports and one first load do not count. The peak is the largest resident
size of that process less the one before the loads. trimesh runs with process=False, which is its fastest way.
Install with: pip install numpy trimesh open3d vtk
"""

import json
import resource
import subprocess
import sys
import time


def trimesh_reader():
    import trimesh

    def read(path):
        mesh = trimesh.load(path, process=False)
        return len(mesh.vertices), len(getattr(mesh, "faces", ()))

    return read


def open3d_reader():
    import open3d

    def read(path):
        mesh = open3d.io.read_triangle_mesh(path)
        return len(mesh.vertices), len(mesh.triangles)

    return read


def vtk_reader():
    from vtkmodules.vtkIOPLY import vtkPLYReader

    def read(path):
        reader = vtkPLYReader()
        reader.SetFileName(path)
        reader.Update()
        output = reader.GetOutput()
        return output.GetNumberOfPoints(), output.GetNumberOfPolys()

    return read


READERS = {"trimesh": trimesh_reader, "Open3D": open3d_reader, "VTK": vtk_reader}


def resident_bytes():
    with open("/proc/self/statm") as statm:
        return int(statm.read().split()[1]) * resource.getpagesize()


def measure(name, path, runs):
    read = READERS[name]()
    before = resident_bytes()
    vertices, triangles = read(path)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 - before
    seconds = []
    for _ in range(runs):
        start = time.perf_counter()
        read(path)
        seconds.append(time.perf_counter() - start)
    return {"seconds": seconds, "peak_bytes": peak, "vertices": vertices, "triangles": triangles}


def main():
    if len(sys.argv) == 4:
        print(json.dumps(measure(sys.argv[3], sys.argv[1], int(sys.argv[2]))))
        return
    results = {}
    for name in READERS:
        child = subprocess.run([sys.executable, __file__, *sys.argv[1:3], name], capture_output=True, text=True)
        if child.returncode == 0:
            results[name] = json.loads(child.stdout.strip().splitlines()[-1])
        else:
            print(f"{name}: {child.stderr.strip()[-300:]}", file=sys.stderr)
    print(json.dumps(results))


if __name__ == "__main__":
    main()
