"""The Aibo's URDF in MuJoCo, held by the same servos as in asami: what mujoco_step.py and mujoco_engine.py share."""

import sys

try:
    import mujoco
    import numpy as np
except ImportError as missing:
    sys.exit(f"MuJoCo is another physics engine, and there is no Python package {missing.name!r}: pip install mujoco numpy")

# MuJoCo warns of parts attached under their own names.
PREFIX = "aibo/"


def spec_of(urdf, time_step_s, gravity_m_per_s2, friction):
    """The robot of a URDF's text, free on a plane, that meets the ground and never itself."""
    spec = mujoco.MjSpec()
    spec.option.timestep = time_step_s
    spec.option.gravity = [0.0, 0.0, -gravity_m_per_s2]
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    # The ground's priority makes its friction count.
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[0, 0, 1],
        friction=[friction, 0.005, 0.0001],
        priority=1,
        contype=1,
        conaffinity=2,
    )
    robot = mujoco.MjSpec.from_string(urdf)
    # A URDF's root is welded to the world: free it.
    spec.worldbody.add_frame().attach_body(robot.worldbody.first_body(), PREFIX, "").add_freejoint()
    for geom in spec.geoms:
        if geom.type != mujoco.mjtGeom.mjGEOM_PLANE:
            geom.contype, geom.conaffinity = 2, 0
    return spec


def add_servo(spec, name, effort_n_m, joint_damping, stiffness, damping, armature_kg_m2):
    """A position servo on a joint, by its name."""
    joint = spec.joint(PREFIX + name)
    joint.armature = armature_kg_m2
    # A vector of three since MuJoCo 4.
    joint.damping = np.array([joint_damping, 0.0, 0.0]) if np.ndim(joint.damping) else joint_damping
    servo = spec.add_actuator(name=name, target=PREFIX + name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    servo.set_to_position(kp=stiffness, kv=damping)
    servo.forcerange, servo.forcelimited = [-effort_n_m, effort_n_m], 1
