#!/usr/bin/env python3
"""Errors of the speed and the turning rate, and milliseconds per scan pair: asami's odometry beside small_gicp and KISS-ICP.

    pip install numpy small_gicp==1.0.1 kiss-icp==1.3.0
    python3 benches/peers/scan_matching.py [--drive NAME ...] [--seconds S] [--seed S] [--rounds N] [--release] [--table FILE]

All match the same turns of a Velodyne HDL-64E, with the lasers' true angles: of KITTI's car (../shared/data/kitti_drive0005,
left out where it is absent) and of a simulated one (scenarios/car.toml).

asami (`cargo run --example scan_pairs`) is `car_lines`: points more than a metre below the scanner dropped, one kept of each square of 0.1 m, drawn to
lines, in two passes. Once it takes every turn, once a turn every half second.

Peers take every turn, in three dimensions, and have the settings of their documentation for such a scanner:
small_gicp: GICP, voxels of 0.25 m, correspondences up to 1 m, 10 neighbours, 20 iterations, from the motion before; and once more with tolerances a
hundredth of its defaults and 100 iterations. It does not set points back itself: that is done here, to the turn's middle, at the velocity of
the pair before, and not timed.
KISS-ICP: ranges up to 100 m, voxels of 1 m, its adaptive threshold, to a map; once with its own deskewing, with every point's true
time (its pose is the turn's end), and once without (its pose is then taken for the turn's middle).

The true motion of a step is that of the track over the very time between the moments whose poses a method gives. Steps are a turn, and
five turns: motions of turns are put together. Which way is forward each finds as asami does: the median direction of its motions.
A difference is a root mean square error of asami's less the peer's; its interval is that of 95 % over 10 000 draws of steps, the same for
both (paired bootstrap). asami is no worse where the interval does not lie above 0.

Each has one thread; what counts is the processor's time, by turns `--rounds` times, the median of each.
"""

import argparse
import importlib.metadata
import os
import pathlib
import statistics
import sys
import tempfile
import time

# Before anything starts threads.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "TBB_NUM_THREADS"):
    os.environ[name] = "1"

try:
    import numpy as np
    import small_gicp
    from kiss_icp.config import KISSConfig
    from kiss_icp.kiss_icp import KissICP
except ImportError as missing:
    sys.exit(f"scan_matching.py needs the Python package {missing.name!r}: pip install numpy small_gicp==1.0.1 kiss-icp==1.3.0")

from example import Example, built, table

ROOT = pathlib.Path(__file__).resolve().parents[2]
KITTI = ROOT.parent / "shared" / "data" / "kitti_drive0005"
LONG = 5
OURS = {"asami, every turn": 0.0, "asami, every half second": 0.5}


class Drive:
    """Turns as the example wrote them."""

    def __init__(self, folder, about):
        read = lambda name, kind: np.fromfile(pathlib.Path(folder) / name, kind)
        turns = read("turns.f64", np.float64).reshape(-1, 3)
        self.begins, self.ends = turns[:, 0], turns[:, 1]
        self.middles = 0.5 * (self.begins + self.ends)
        cuts = np.cumsum(turns[:, 2].astype(int))[:-1]
        self.points = np.split(read("points.f32", np.float32).reshape(-1, 3).astype(np.float64), cuts)
        self.times = np.split(read("times.f64", np.float64), cuts)
        track = read("track.f64", np.float64).reshape(-1, 4)
        self.track_t, self.track_xy, self.track_theta = track[:, 0], track[:, 1:3], np.unwrap(track[:, 3])
        assert len(self.points) == about["turns"]

    def moved(self, from_s, to_s):
        """Mean forward speed and turning rate, as the average heading of the time sees them; none outside of the track."""
        at = lambda t, values: np.interp(t, self.track_t, values, left=np.nan, right=np.nan)
        (x0, y0, a0), (x1, y1, a1) = ([at(t, v) for v in (*self.track_xy.T, self.track_theta)] for t in (from_s, to_s))
        dt, heading = to_s - from_s, 0.5 * (a0 + a1)
        return np.stack([((y1 - y0) * np.cos(heading) - (x1 - x0) * np.sin(heading)) / dt, (a1 - a0) / dt], axis=1)


def planar(pose):
    return np.array([pose[0, 3], pose[1, 3], np.arctan2(pose[1, 0], pose[0, 0])])


def turned(angle, x, y):
    return np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y


def together(motions, count):
    """Every `count` motions in a row as one; a rest is left out."""
    whole = []
    for first in range(0, len(motions) - count + 1, count):
        x, y, angle = 0.0, 0.0, 0.0
        for motion in motions[first:first + count]:
            dx, dy = turned(angle, motion[0], motion[1])
            x, y, angle = x + dx, y + dy, angle + motion[2]
        whole.append([x, y, angle])
    return np.array(whole)


def errors(drive, motions, moments):
    """Speed and turning rate less the true ones, a row a step."""
    dt = np.diff(moments)
    x, y = turned(-0.5 * motions[:, 2], motions[:, 0], motions[:, 1])
    forward = np.median(np.arctan2(y, x)[np.hypot(x, y) > 2.0 * dt])
    found = np.stack([turned(-forward, x, y)[0] / dt, motions[:, 2] / dt], axis=1)
    return found - drive.moved(moments[:-1], moments[1:])


def set_back(points, times, moment, speed):
    """Points as seen at `moment` from a scanner that moves evenly in the plane: x, y and turn a second."""
    late = times - moment
    angle = speed[2] * late
    x, y = turned(angle, points[:, 0], points[:, 1])
    dx, dy = turned(0.5 * angle, speed[0] * late, speed[1] * late)
    return np.stack([x + dx, y + dy, points[:, 2]], axis=1)


def speed_of(motion, dt):
    x, y = turned(-0.5 * motion[2], motion[0], motion[1])
    return np.array([x, y, motion[2]]) / dt


def with_gicp(drive, tight):
    """Motions from middle to middle, and seconds."""
    options = {"rotation_epsilon": 1.75e-5, "translation_epsilon": 1e-5, "max_iterations": 100} if tight else {}

    def prepared(k, speed):
        points = drive.points[k]
        points = points if speed is None else set_back(points, drive.times[k], drive.middles[k], speed)
        begun = time.process_time()
        cloud = small_gicp.preprocess_points(points, downsampling_resolution=0.25, num_neighbors=10, num_threads=1)
        return cloud, time.process_time() - begun

    def aligned(earlier, later, guess):
        begun = time.process_time()
        found = small_gicp.align(earlier[0], later[0], earlier[1], init_T_target_source=guess, registration_type="GICP",
                                 max_correspondence_distance=1.0, num_threads=1, **options)
        return found.T_target_source, time.process_time() - begun

    # How fast the car is at first, of turns as they are; not timed.
    dt = np.diff(drive.middles)
    guess, _ = aligned(prepared(0, None)[0], prepared(1, None)[0], np.eye(4))
    speed = speed_of(planar(guess), dt[0])
    motions, (before, seconds) = [], prepared(0, speed)
    for k in range(1, len(drive.points)):
        now, preparing = prepared(k, speed)
        guess, aligning = aligned(before, now, guess)
        seconds += preparing + aligning
        motions.append(planar(guess))
        speed, before = speed_of(motions[-1], dt[k - 1]), now
    return np.array(motions), drive.middles, seconds


def with_kiss(drive, deskew):
    """Motions from end to end or middle to middle, and seconds."""
    config = KISSConfig()
    config.data.deskew, config.data.max_range, config.data.min_range = deskew, 100.0, 0.0
    config.mapping.voxel_size, config.registration.max_num_threads = 1.0, 1
    odometry, poses, seconds = KissICP(config), [], 0.0
    for points, times in zip(drive.points, drive.times):
        begun = time.process_time()
        odometry.register_frame(points, times)
        seconds += time.process_time() - begun
        poses.append(odometry.last_pose.copy())
    motions = [planar(np.linalg.inv(a) @ b) for a, b in zip(poses, poses[1:])]
    return np.array(motions), drive.ends if deskew else drive.middles, seconds


def peers():
    version = importlib.metadata.version
    gicp, kiss = f"small_gicp {version('small_gicp')}", f"KISS-ICP {version('kiss-icp')}"
    return {
        f"{gicp}, GICP": lambda drive: with_gicp(drive, tight=False),
        f"{gicp}, GICP, fine tolerances": lambda drive: with_gicp(drive, tight=True),
        f"{kiss}, deskewed": lambda drive: with_kiss(drive, deskew=True),
        f"{kiss}, not deskewed": lambda drive: with_kiss(drive, deskew=False),
    }


def of_ours(drive, found, every):
    """Errors by steps' length in turns."""
    rows = np.array(found["motions"])
    if len(rows) != found["pairs"]:
        sys.exit(f"asami matched {len(rows)} of {found['pairs']} pairs: steps would not be the same")
    moments = np.append(rows[:, 0], rows[-1, 0] + rows[-1, 1])
    if every > 0.0:
        return {LONG: errors(drive, rows[:, 2:], moments)}
    return {count: of_turns(drive, rows[:, 2:], moments, count) for count in (1, LONG)}


def of_turns(drive, motions, moments, count):
    whole = together(motions, count)
    return errors(drive, whole, moments[::count][:len(whole) + 1])


def rms(off):
    return np.sqrt(np.mean(off * off, axis=0))


def interval(ours, peer):
    """Of the difference of root mean squares, each column by itself."""
    draws = np.random.default_rng(1000).integers(0, len(ours), (10_000, len(ours)))
    off = np.sqrt((ours ** 2)[draws].mean(axis=1)) - np.sqrt((peer ** 2)[draws].mean(axis=1))
    return np.quantile(off, [0.025, 0.975], axis=0)


def compare(name, source, program, rounds):
    """Rows of the table."""
    with tempfile.TemporaryDirectory() as folder:
        ours = Example(program, [folder, *source])
        drive = Drive(folder, ours.about)
        off, spent = {}, {}
        for _ in range(rounds):
            for label, every in OURS.items():
                found = ours.ask(every)
                spent.setdefault(label, []).append(1e3 * found["seconds"] / found["pairs"])
                off[label] = of_ours(drive, found, every)
            for label, run in peers().items():
                motions, moments, seconds = run(drive)
                spent.setdefault(label, []).append(1e3 * seconds / len(motions))
                off[label] = {count: of_turns(drive, motions, moments, count) for count in (1, LONG)}
        ours.close()
    rows = []
    for count in (1, LONG):
        there = {label: found[count] for label, found in off.items() if count in found}
        # Steps of which every method has one, within the track.
        n = min(len(found) for found in there.values())
        known = np.all([np.isfinite(found[:n]).all(axis=1) for found in there.values()], axis=0)
        there = {label: found[:n][known] for label, found in there.items()}
        best = next(label for label in reversed(OURS) if label in there)
        for label, found in there.items():
            row = [name, f"{count} turn{'s' if count > 1 else ''}", str(len(found)), label,
                   f"{rms(found)[0]:.4f}", f"{rms(found)[1]:.5f}", f"{found[:, 0].mean():+.4f}"]
            if label in OURS:
                row += ["", ""]
            else:
                low, high = interval(there[best], found)
                row += [f"{low[k]:+.{4 + k}f} to {high[k]:+.{4 + k}f}{', worse' if low[k] > 0.0 else ''}" for k in (0, 1)]
            rows.append(row + [f"{statistics.median(spent[label]):.1f}"])
    return rows


HEADS = ["drive", "step", "steps", "method", "speed (m/s)", "turning (rad/s)", "mean of the speed's error (m/s)", "asami less it, speed",
         "asami less it, turning", "ms per pair"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--drive", nargs="+", choices=["kitti", "simulated"], default=["kitti", "simulated"])
    parser.add_argument("--seconds", type=float, default=40.0, help="of the simulated drive (default 40)")
    parser.add_argument("--seed", type=int, default=1000, help="of the simulated drive (default 1000)")
    parser.add_argument("--rounds", type=int, default=3, help="how often each is timed (default 3)")
    parser.add_argument("--release", action="store_true", help="time asami built with --release, not the dev profile")
    parser.add_argument("--table", type=pathlib.Path, help="writes the table there, in Markdown")
    arguments = parser.parse_args()
    rounds = max(arguments.rounds, 1)
    program, rows = built("scan_pairs", arguments.release), []
    if "kitti" in arguments.drive:
        if KITTI.is_dir():
            rows += compare("KITTI 0005", [KITTI], program, rounds)
        else:
            print(f"KITTI's drive is left out: {KITTI} is absent", file=sys.stderr)
    if "simulated" in arguments.drive:
        source = ["scenarios/car.toml", arguments.seed, arguments.seconds]
        rows += compare(f"car, seed {arguments.seed}", source, program, rounds)
    profile = "release" if arguments.release else "dev"
    below = (f"Root mean square errors; 95 % intervals of asami's less the peer's by a paired bootstrap (of five turns, asami matching every half "
             f"second); processor time, one thread each, median of {rounds} rounds, asami in the {profile} profile.")
    table(HEADS, rows, below, arguments.table)


if __name__ == "__main__":
    main()
