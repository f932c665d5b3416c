#!/usr/bin/env python3
"""MuJoCo as the Aibo's physics engine in asami's worlds, line by line (docs/engines.md).

    pip install mujoco numpy
    cargo run --bin generate scenarios/aibo_1d.toml --withhold --salt "release 0.1" --cases 40 \\
        -o results/foreign_aibo --engine "python3 benches/peers/mujoco_engine.py"

Gait, servos' set-points, camera and effects are asami's; how legs, feet and ground move each other is MuJoCo's. The
first line on standard input says how the body begins, every further one what holds during the next step; each is
answered with where the body is.
"""

import json
import sys

from mujoco_robot import PREFIX, add_servo, mujoco, np, spec_of

LEGS = ("fl", "fr", "hl", "hr")
WORLD = 0


class Engine:
    """The body, as its first line says it begins."""

    def __init__(self, begin):
        if begin.get("asami_engine") != 1:
            raise ValueError(f"lines of version {begin.get('asami_engine')!r} are not known here, version 1 is")
        self.begin = begin
        joints = begin["joints"]
        spec = spec_of(begin["urdf"], begin["time_step_s"], begin["gravity_m_per_s2"], 1.0)
        spec.option.gravity = self.gravity()
        for joint in joints:
            add_servo(
                spec,
                joint["name"],
                joint["effort_n_m"],
                joint["damping_n_m_s_per_rad"],
                begin["stiffness_n_m_per_rad"],
                begin["damping_n_m_s_per_rad"],
                begin["armature_kg_m2"],
            )
        for leg, short_m in zip(LEGS, begin["short_m"]):
            lowest = min(spec.body(f"{PREFIX}{leg}_lower").geoms, key=lambda geom: geom.pos[2])
            lowest.pos = lowest.pos + np.array([0.0, 0.0, short_m])
            lowest.name = f"{leg}_foot"
        for geom in spec.geoms:
            # Not the ground's friction counts, as in asami, but each shape's own.
            if geom.type != mujoco.mjtGeom.mjGEOM_PLANE:
                geom.priority = 2
        if begin["payload_kg"] > 0.0:
            spec.body(f"{PREFIX}torso").add_geom(
                type=mujoco.mjtGeom.mjGEOM_SPHERE,
                size=[begin["payload_radius_m"], 0, 0],
                pos=[begin["payload_ahead_m"], 0.0, begin["payload_up_m"]],
                mass=begin["payload_kg"],
                contype=0,
                conaffinity=0,
            )
        self.model = model = spec.compile()
        self.data = mujoco.MjData(model)
        self.torso, self.head = (model.body(PREFIX + name).id for name in ("torso", "head"))
        self.feet = [model.geom(f"{leg}_foot").id for leg in LEGS]
        self.ground = next(i for i in range(model.ngeom) if model.geom_bodyid[i] == WORLD)
        self.shell = [i for i in range(model.ngeom) if i != self.ground and i not in self.feet]
        self.angles = [model.joint(PREFIX + joint["name"]).qposadr[0] for joint in joints]
        self.effort = np.array([joint["effort_n_m"] for joint in joints])
        self.data.qpos[:7] = begin["world_from_torso"]
        self.data.qpos[self.angles] = self.data.ctrl[:] = [joint["angle_rad"] for joint in joints]
        mujoco.mj_forward(model, self.data)

    def gravity(self):
        """Gravity in the inclined ground's own axes."""
        x, y = self.begin["slope"]
        level = max(0.0, 1.0 - x * x - y * y) ** 0.5
        return [-self.begin["gravity_m_per_s2"] * part for part in (x, y, level)]

    def step(self, order):
        """One step under what holds during it."""
        model, data = self.model, self.data
        data.ctrl[:] = order["aim_rad"]
        # Three motors a leg, then the head's, which no effect weakens.
        ratio = np.ones(len(self.effort))
        ratio[:12] = np.repeat(order["torque_ratio"], 3)
        stiffness = ratio * self.begin["stiffness_n_m_per_rad"]
        model.actuator_gainprm[:, 0], model.actuator_biasprm[:, 1] = stiffness, -stiffness
        model.actuator_forcerange[:, 0], model.actuator_forcerange[:, 1] = -ratio * self.effort, ratio * self.effort
        model.geom_friction[self.feet, 0] = order["feet_friction"]
        model.geom_friction[self.shell, 0] = order["shell_friction"]
        mujoco.mj_step(model, data)
        # Places and turns of links after the step, not before it.
        mujoco.mj_kinematics(model, data)

    def answer(self):
        data = self.data
        pairs = {geom for contact in data.contact[: data.ncon] for geom in (contact.geom1, contact.geom2)}
        return {
            "torso": [*data.xpos[self.torso], *data.xquat[self.torso]],
            "head": [*data.xpos[self.head], *data.xquat[self.head]],
            "angles_rad": list(data.qpos[self.angles]),
            "feet_down": [foot in pairs for foot in self.feet],
            "mass_kg": float(self.model.body_mass.sum()),
        }


def main():
    if sys.stdin.isatty():
        sys.exit(__doc__)
    engine = None
    for line in sys.stdin:
        order = json.loads(line)
        if engine is None:
            engine = Engine(order)
        else:
            engine.step(order)
        print(json.dumps(engine.answer()), flush=True)


if __name__ == "__main__":
    main()
