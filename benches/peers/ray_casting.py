#!/usr/bin/env python3
"""Million rays per second and core: asami's ray caster beside Embree and Open3D, same towns, same rays.

    pip install numpy embreex open3d        # either peer may be missing; Embree's packets also need a C compiler
    python3 benches/peers/ray_casting.py [--detail D ...] [--rounds N] [--table FILE]

asami builds a town, aims a Velodyne along its route and casts the rays (`cargo run --release --example rays`).
Embree casts the same rays at the same triangles: 16 and 8 to a packet, told that they are coherent or not, and
singly; it comes out of the embreex wheel, whose own interface (a NumPy array of single rays) is timed too, and so is
Open3D's. All stand on one thread and are timed by that thread's own clock, by turns, `--rounds` times; the best round
of each counts. Ranges are compared with Embree's single rays.
"""

import argparse
import ctypes
import os
import pathlib
import subprocess
import sys
import tempfile
import time

from example import Example, built, table

SHIM = pathlib.Path(__file__).resolve().with_name("embree_packets.c")

# Before anything starts threads.
os.environ.setdefault("OMP_NUM_THREADS", "1")

try:
    import numpy as np
except ImportError as missing:
    sys.exit(f"ray_casting.py needs the Python package {missing.name!r}: pip install numpy")


def embree_packets(folder, vertices, triangles, rays, reach):
    """Name and caster of every mode of Embree's own interface."""
    try:
        import embreex
    except ImportError as missing:
        print(f"Embree is left out: {missing} (pip install embreex)")
        return {}
    found = sorted(pathlib.Path(embreex.__file__).parent.parent.glob("embreex*/**/libembree4*.so*"))
    if not found:
        print("Embree's packets are left out: the embreex package has no libembree4.so here")
        return {}
    built = pathlib.Path(folder) / "embree_packets.so"
    compiler = os.environ.get("CC", "cc")
    try:
        subprocess.run([compiler, "-O3", "-shared", "-fPIC", str(SHIM), "-o", str(built), "-ldl"], check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        print(f"Embree's packets are left out: {compiler} does not build {SHIM.name} ({error})")
        return {}
    # Its wheel's copy of TBB must be there before it.
    import embreex.rtcore  # noqa: F401
    shim = ctypes.CDLL(str(built))
    pointer = lambda array: array.ctypes.data_as(ctypes.c_void_p)
    shim.embree_cast.restype = ctypes.c_double
    size, number = ctypes.c_size_t, ctypes.c_float
    status = shim.embree_open(
        str(found[0]).encode(), pointer(vertices), size(len(vertices) - 1), pointer(triangles), size(len(triangles)), 0
    )
    if status:
        print(f"Embree's packets are left out: {found[0].name} does not load ({status})")
        return {}
    ranges = np.empty(rays.shape[2], np.float32)

    def mode(width, coherent):
        def cast():
            spent = shim.embree_cast(
                width, coherent, pointer(rays[0]), pointer(rays[1]), pointer(ranges), size(len(ranges)), number(reach)
            )
            return spent, np.where(ranges < reach, ranges, np.inf)
        return cast

    modes = {}
    for width in (16, 8, 1):
        for coherent in (1, 0):
            modes[f"Embree, {width} to a packet, {'coherent' if coherent else 'incoherent'}"] = mode(width, coherent)
    return modes


def embreex_scene(vertices, triangles, rays, reach):
    try:
        from embreex import rtcore_scene
        from embreex.mesh_construction import TriangleMesh
    except ImportError:
        return {}
    scene = rtcore_scene.EmbreeScene()
    TriangleMesh(scene, vertices[:-1], triangles.astype(np.int32))
    origins, directions = (np.ascontiguousarray(part.T) for part in rays)

    def cast():
        begun = time.thread_time()
        hits = scene.run(origins, directions, dists=np.full(len(origins), reach, np.float32), output=True)
        return time.thread_time() - begun, np.where(hits["primID"] >= 0, hits["tfar"], np.inf)

    return {"embreex, scene.run": cast}


def open3d_scene(vertices, triangles, rays, reach):
    try:
        import open3d
    except ImportError as missing:
        print(f"Open3D is left out: {missing} (pip install open3d; it also needs the system's libusb and OpenGL)")
        return {}
    scene = open3d.t.geometry.RaycastingScene(nthreads=1)
    scene.add_triangles(open3d.core.Tensor(vertices[:-1]), open3d.core.Tensor(triangles))
    both = open3d.core.Tensor(np.ascontiguousarray(np.concatenate([part.T for part in rays], axis=1)))

    def cast():
        # It casts on threads of its own.
        begun = time.process_time()
        hits = scene.cast_rays(both, nthreads=1)
        spent = time.process_time() - begun
        ranges = hits["t_hit"].numpy()
        return spent, np.where(ranges <= reach, ranges, np.inf)

    return {"Open3D, RaycastingScene": cast}


def compare(folder, detail, rounds):
    ours = Example(built("rays", True, "asami-sim"), [folder, detail])
    about = ours.about
    read = lambda name, kind: np.fromfile(pathlib.Path(folder) / name, kind)
    # Embree reads vertices four floats at a time: one more behind the last.
    vertices = np.concatenate([read("vertices.f32", np.float32), np.zeros(3, np.float32)]).reshape(-1, 3)
    triangles = read("triangles.u32", np.uint32).reshape(-1, 3)
    rays = read("rays.f32", np.float32).reshape(2, 3, -1)
    reach = about["reach_m"]
    peers = embree_packets(folder, vertices, triangles, rays, reach)
    peers |= embreex_scene(vertices, triangles, rays, reach)
    peers |= open3d_scene(vertices, triangles, rays, reach)

    best, ranges = {}, {}
    for _ in range(max(rounds, 1)):
        turn = {f"asami, {name}": seconds for name, seconds in ours.ask("").items()}
        for name, cast in peers.items():
            turn[name], ranges[name] = cast()
        for name, seconds in turn.items():
            best[name] = min(seconds, best.get(name, np.inf))
    ranges["asami"] = read("ranges.f32", np.float32)
    ours.close()

    fastest = min(seconds for name, seconds in best.items() if name.startswith("asami"))
    truth = next((ranges[name] for name in ranges if name.startswith("Embree, 1 ")), None)

    def apart(name):
        other = ranges.get("asami" if name.startswith("asami") else name)
        if truth is None or other is None:
            return ""
        with np.errstate(invalid="ignore"):
            off = np.abs(other - truth)
        off[np.isinf(other) & np.isinf(truth)] = 0.0
        return str(np.count_nonzero(off > 1e-3))

    rows = sorted(best.items(), key=lambda row: row[1])
    return [[str(about["triangles"]), name, f"{1e-6 * about['rays'] / seconds:.1f}", f"{seconds / fastest:.2f}", apart(name)]
            for name, seconds in rows], about["rays"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--detail", type=float, nargs="+", default=[0.0, 0.9], help="towns' detail, 0 to 1 (default 0 and 0.9)")
    parser.add_argument("--rounds", type=int, default=5, help="how often each is timed (default 5)")
    parser.add_argument("--table", type=pathlib.Path, help="writes the table there, in Markdown")
    arguments = parser.parse_args()
    rows, rays = [], 0
    for detail in arguments.detail:
        with tempfile.TemporaryDirectory() as folder:
            found, rays = compare(folder, detail, arguments.rounds)
        rows += found
    below = (f"{rays} rays of a Velodyne that drives through a town, bundled by 64 as asami casts them; one thread each, best of {arguments.rounds} rounds, "
             "asami in the release profile.")
    table(["triangles", "caster", "million rays a second", "times asami's time", "rays off Embree's single ones by more than 1 mm"], rows, below, arguments.table)


if __name__ == "__main__":
    main()
