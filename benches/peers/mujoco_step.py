#!/usr/bin/env python3
"""Microseconds per engine step, MuJoCo beside asami's Rapier, on the same walk.

    pip install mujoco numpy
    python3 benches/peers/mujoco_step.py [--release] [--rounds N] [--table FILE]

asami walks its URDF in open loop and prints what it did (`cargo run --example gait_steps`). MuJoCo then
plays the same servo set-points on the same URDF at the same time step, with the same servo gains, efforts,
armature, joint damping and friction. Only the engines' own step calls are timed. A walk's figure is the
median over its control ticks; the two walk by turns, `--rounds` times, and the best walk of each counts.
The speeds show that both walk.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import time

from example import table
from mujoco_robot import PREFIX, add_servo, mujoco, np, spec_of

ROOT = pathlib.Path(__file__).resolve().parents[2]
URDF = ROOT / "urdf" / "aibo_ers7.urdf"


def asami_walk(release):
    command = ["cargo", "run", "--quiet", "--example", "gait_steps"] + (["--release"] if release else [])
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(command)} failed with status {done.returncode}")
    return json.loads(done.stdout)


def mujoco_model(walk):
    spec = spec_of(URDF.read_text(), walk["time_step_s"], walk["gravity_m_per_s2"], walk["friction"])
    for name, effort, damping in zip(walk["joints"], walk["effort_n_m"], walk["joint_damping_n_m_s_per_rad"]):
        servo = (walk["stiffness_n_m_per_rad"], walk["damping_n_m_s_per_rad"], walk["armature_kg_m2"])
        add_servo(spec, name, effort, damping, *servo)
    return spec.compile()


def mujoco_walk(walk):
    model = mujoco_model(walk)
    data = mujoco.MjData(model)
    data.qpos[:7] = [0.0, 0.0, walk["start_height_m"], *walk["start_quaternion_wxyz"]]
    for name, angle in zip(walk["joints"], walk["start_angles_rad"]):
        data.qpos[model.joint(PREFIX + name).qposadr[0]] = angle
    data.ctrl[:] = walk["start_angles_rad"]
    mujoco.mj_step(model, data, walk["settle_steps"])

    set_points = np.array(walk["set_points_rad"])
    steps_per_tick, half = walk["steps_per_tick"], len(set_points) // 2
    spent_ns = []
    for tick, aimed in enumerate(set_points):
        data.ctrl[:] = aimed
        begun = time.perf_counter_ns()
        mujoco.mj_step(model, data, steps_per_tick)
        spent_ns.append(time.perf_counter_ns() - begun)
        if tick == half - 1:
            half_way_m = data.qpos[0]
    speed = (data.qpos[0] - half_way_m) / ((len(set_points) - half) * steps_per_tick * walk["time_step_s"])
    return {
        "microseconds_per_step": float(np.median(spent_ns)) * 1e-3 / steps_per_tick,
        "speed_m_per_s": speed,
        "upright": data.body(PREFIX + "torso").xmat[8],
        "mass_kg": model.body_mass.sum(),
        "degrees_of_freedom": model.nv,
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--release", action="store_true", help="time asami built with --release, not the dev profile")
    parser.add_argument("--rounds", type=int, default=3, help="how often each engine is timed (default 3)")
    parser.add_argument("--table", type=pathlib.Path, help="writes the table there, in Markdown")
    arguments = parser.parse_args()
    asami_walk(arguments.release)  # Builds, and warms the processor up.

    ours, theirs = [], []
    for _ in range(max(arguments.rounds, 1)):
        ours.append(asami_walk(arguments.release))
        theirs.append(mujoco_walk(ours[-1]))
    rapier = min(ours, key=lambda walk: walk["microseconds_per_step"])
    peer = min(theirs, key=lambda walk: walk["microseconds_per_step"])
    if peer["upright"] < 0.8:
        sys.exit("MuJoCo's robot fell: the two did not do the same work")
    profile = "release" if arguments.release else "dev"
    walks = {f"asami, Rapier ({profile})": rapier, f"MuJoCo {mujoco.__version__}": peer}
    rows = [[name, f"{walk['microseconds_per_step']:.1f}", f"{walk['microseconds_per_step'] / peer['microseconds_per_step']:.1f}",
             f"{1e3 * walk['speed_m_per_s']:.1f}"] for name, walk in walks.items()]
    below = (f"{URDF.name}: {peer['degrees_of_freedom']} degrees of freedom, {peer['mass_kg']:.3f} kg, {len(rapier['set_points_rad'])} ticks of "
             f"{rapier['steps_per_tick']} steps of {1e3 * rapier['time_step_s']:g} ms, best of {len(ours)} rounds.")
    table(["engine", "us a step", "times MuJoCo's", "walks at (mm/s)"], rows, below, arguments.table)


if __name__ == "__main__":
    main()
