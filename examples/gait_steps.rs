//! Times the engine on a walking Aibo and prints, as JSON, the time and all that another engine needs to do the same
//! work: `benches/peers/mujoco_step.py` reads it.

#[path = "../benches/walk/mod.rs"]
mod walk;

use std::time::{Duration, Instant};

use asami_sim::robots::aibo::BuildError;
use asami_sim::robots::aibo::blueprint::JOINT_NAMES;
use asami_sim::robots::aibo::engine::Engine as _;
use serde_json::json;

/// 10 s at the default time step.
const TICKS: usize = 1250;

fn main() -> Result<(), BuildError> {
    let mut walk = walk::Walk::new()?;
    let physics = walk.config.physics.clone();
    let settle_steps = (physics.settle_s / physics.time_step_s).round() as usize;
    for _ in 0..settle_steps {
        walk.body.step();
    }
    let (mut set_points_rad, mut ahead_m) = (Vec::new(), Vec::new());
    let mut spent: Vec<Duration> = Vec::with_capacity(TICKS);
    for _ in 0..TICKS {
        set_points_rad.push(walk.aim());
        let begun = Instant::now();
        for _ in 0..physics.steps_per_tick {
            walk.body.step();
        }
        spent.push(begun.elapsed());
        ahead_m.push(walk.body.world_from_torso().translation.x);
    }
    // The median: other programs' turns at the processor fall into few ticks.
    spent.sort();
    let steps = TICKS as f64 * f64::from(physics.steps_per_tick);
    let second_half_s = 0.5 * steps * physics.time_step_s;
    let joints = &walk.blueprint.joints;
    let report = json!({
        "microseconds_per_step": spent[TICKS / 2].as_secs_f64() * 1e6 / f64::from(physics.steps_per_tick),
        "speed_m_per_s": (ahead_m[TICKS - 1] - ahead_m[TICKS / 2 - 1]) / second_half_s,
        "time_step_s": physics.time_step_s,
        "steps_per_tick": physics.steps_per_tick,
        "settle_steps": settle_steps,
        "friction": physics.friction,
        "gravity_m_per_s2": physics.gravity_m_per_s2,
        "stiffness_n_m_per_rad": walk.config.servo.stiffness_n_m_per_rad,
        "damping_n_m_s_per_rad": walk.config.servo.damping_n_m_s_per_rad,
        "armature_kg_m2": walk.config.servo.armature_kg_m2,
        "joints": JOINT_NAMES,
        "effort_n_m": joints.iter().map(|joint| joint.effort_n_m).collect::<Vec<_>>(),
        "joint_damping_n_m_s_per_rad": joints.iter().map(|joint| joint.damping_n_m_s_per_rad).collect::<Vec<_>>(),
        "start_height_m": walk.world_from_torso.translation.z,
        "start_quaternion_wxyz": [
            walk.world_from_torso.rotation.w,
            walk.world_from_torso.rotation.i,
            walk.world_from_torso.rotation.j,
            walk.world_from_torso.rotation.k,
        ],
        "start_angles_rad": walk.angles_rad,
        "set_points_rad": set_points_rad,
    });
    println!("{report}");
    Ok(())
}
