//! The body in another program's physics engine, which is told and asked over pipes (`docs/engines.md`).
//!
//! One line of JSON each way: first how the body begins, then once a step what its motors are given. An engine that stops
//! or answers nonsense leaves the body where it was, and [`Engine::broken`] says why.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use serde::{Deserialize, Serialize};

use super::BuildError;
use super::blueprint::{Blueprint, JOINT_NAMES, JOINTS, URDF};
use super::body::{PAYLOAD_RADIUS_M, PAYLOAD_UP_M};
use super::config::AiboConfig;
use super::engine::Engine;
use crate::knobs::BodyKnobs;

/// Version of the lines.
const PROTOCOL: u32 = 1;
/// Longest line that is read: an answer has a few hundred characters.
const LONGEST: u64 = 1 << 16;
/// So much of an answer that is none is shown.
const SHOWN: usize = 200;

/// Place in metres, then turn as a quaternion, w first.
type Pose = [f64; 7];

/// The first line: the body as it begins.
#[derive(Clone, Debug, Serialize)]
struct Begin<'a> {
    asami_engine: u32,
    urdf: &'a str,
    time_step_s: f64,
    gravity_m_per_s2: f64,
    world_from_torso: Pose,
    joints: Vec<Joint<'a>>,
    stiffness_n_m_per_rad: f64,
    damping_n_m_s_per_rad: f64,
    armature_kg_m2: f64,
    payload_kg: f64,
    payload_ahead_m: f64,
    payload_up_m: f64,
    payload_radius_m: f64,
    short_m: [f64; 4],
    slope: [f64; 2],
}

#[derive(Clone, Debug, Serialize)]
struct Joint<'a> {
    name: &'a str,
    angle_rad: f64,
    effort_n_m: f64,
    damping_n_m_s_per_rad: f64,
}

/// Every further line: what holds during the next step.
#[derive(Clone, Debug, Serialize)]
struct Step {
    aim_rad: Vec<f64>,
    torque_ratio: [f64; 4],
    feet_friction: [f64; 4],
    shell_friction: f64,
}

/// What is answered, to the first line as to all others.
#[derive(Clone, Debug, Deserialize)]
struct Answer {
    torso: Pose,
    head: Pose,
    angles_rad: [f64; JOINTS],
    feet_down: [bool; 4],
    mass_kg: f64,
}

/// How to start another program's engine: the program and its arguments.
pub type Program = [String];

/// The Aibo in another program's engine.
pub struct Outside {
    begin: Option<Begin<'static>>,
    step: Step,
    now: Answer,
    pipes: Option<(ChildStdin, BufReader<ChildStdout>)>,
    child: Child,
    broken: Option<String>,
}

impl Outside {
    /// Starts the program, and has it put the body at a pose of its torso (URDF axes: x forward) when the first step is
    /// due.
    ///
    /// # Errors
    /// If the program does not start.
    pub fn new(
        program: &Program,
        config: &AiboConfig,
        blueprint: &Blueprint,
        world_from_torso: &Isometry3<f64>,
        angles_rad: &[f64; JOINTS],
    ) -> Result<Self, BuildError> {
        let cannot = |why: String| BuildError::Engine(program.join(" "), why);
        let (name, arguments) = program.split_first().ok_or_else(|| cannot("no program is named".to_owned()))?;
        let mut command = Command::new(name);
        command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = command.spawn().map_err(|error| cannot(error.to_string()))?;
        let pipes = child.stdin.take().zip(child.stdout.take().map(BufReader::new));
        let joint = |i: usize| Joint {
            name: JOINT_NAMES[i],
            angle_rad: angles_rad[i],
            effort_n_m: blueprint.joints[i].effort_n_m,
            damping_n_m_s_per_rad: blueprint.joints[i].damping_n_m_s_per_rad,
        };
        let (physics, servo, pose) = (&config.physics, &config.servo, in_numbers(world_from_torso));
        let begin = Begin {
            asami_engine: PROTOCOL,
            urdf: URDF,
            time_step_s: physics.time_step_s,
            gravity_m_per_s2: physics.gravity_m_per_s2,
            world_from_torso: pose,
            joints: (0..JOINTS).map(joint).collect(),
            stiffness_n_m_per_rad: servo.stiffness_n_m_per_rad,
            damping_n_m_s_per_rad: servo.damping_n_m_s_per_rad,
            armature_kg_m2: servo.armature_kg_m2,
            payload_kg: 0.0,
            payload_ahead_m: 0.0,
            payload_up_m: f64::from(PAYLOAD_UP_M),
            payload_radius_m: f64::from(PAYLOAD_RADIUS_M),
            short_m: [0.0; 4],
            slope: [0.0; 2],
        };
        let step = Step {
            aim_rad: angles_rad.to_vec(),
            torque_ratio: [1.0; 4],
            feet_friction: [physics.friction; 4],
            shell_friction: physics.friction,
        };
        let now = Answer { torso: pose, head: pose, angles_rad: *angles_rad, feet_down: [false; 4], mass_kg: 0.0 };
        Ok(Self { begin: Some(begin), step, now, pipes, child, broken: None })
    }

    /// Says a line and hears one.
    fn ask(&mut self, line: Result<String, serde_json::Error>) -> Result<Answer, String> {
        let line = line.map_err(|error| error.to_string())?;
        let (said, heard) = self.pipes.as_mut().ok_or("it has no pipes")?;
        let failed = |error: std::io::Error| format!("it stopped: {error}");
        said.write_all(line.as_bytes()).and_then(|()| said.write_all(b"\n")).map_err(failed)?;
        said.flush().map_err(failed)?;
        let mut answer = String::new();
        std::io::Read::take(heard, LONGEST).read_line(&mut answer).map_err(failed)?;
        if answer.is_empty() {
            return Err("it stopped without an answer".to_owned());
        }
        let nonsense =
            |error| format!("it answered {:?}: {error}", answer.trim_end().chars().take(SHOWN).collect::<String>());
        let answer: Answer = serde_json::from_str(&answer).map_err(nonsense)?;
        let numbers = answer.torso.iter().chain(&answer.head).chain(&answer.angles_rad);
        if numbers.into_iter().all(|number| number.is_finite()) {
            Ok(answer)
        } else {
            Err("it answered numbers that are none".to_owned())
        }
    }

    /// Asks unless the engine is broken, and keeps what is answered.
    fn exchange(&mut self, line: Result<String, serde_json::Error>) {
        if self.broken.is_none() {
            match self.ask(line) {
                Ok(answer) => self.now = answer,
                Err(why) => self.broken = Some(why),
            }
        }
    }
}

impl Engine for Outside {
    fn load(&mut self, knobs: &BodyKnobs) {
        if let Some(begin) = &mut self.begin {
            (begin.payload_kg, begin.payload_ahead_m) = (knobs.payload_kg, knobs.payload_ahead_m);
            begin.short_m = knobs.short_m;
        }
    }

    fn incline(&mut self, slope: [f64; 2]) {
        if let Some(begin) = &mut self.begin {
            begin.slope = slope;
        }
    }

    fn set_torque(&mut self, ratios: [f64; 4]) {
        self.step.torque_ratio = ratios;
    }

    fn set_friction(&mut self, feet: [f64; 4], shell: f64) {
        (self.step.feet_friction, self.step.shell_friction) = (feet, shell);
    }

    fn aim(&mut self, set_points_rad: &[f64]) {
        self.step.aim_rad = set_points_rad.to_vec();
    }

    fn step(&mut self) {
        if let Some(begin) = self.begin.take() {
            self.exchange(serde_json::to_string(&begin));
        }
        self.exchange(serde_json::to_string(&self.step));
    }

    fn angle_rad(&self, i: usize) -> f64 {
        self.now.angles_rad.get(i).copied().unwrap_or(f64::NAN)
    }

    fn feet_down(&self) -> [bool; 4] {
        self.now.feet_down
    }

    fn world_from_torso(&self) -> Isometry3<f64> {
        pose(self.now.torso)
    }

    fn world_from_head(&self) -> Isometry3<f64> {
        pose(self.now.head)
    }

    fn world_from_link(&self, name: &str) -> Option<Isometry3<f64>> {
        match name {
            "torso" => Some(self.world_from_torso()),
            "head" => Some(self.world_from_head()),
            _ => None,
        }
    }

    fn mass_kg(&self) -> f64 {
        self.now.mass_kg
    }

    fn broken(&self) -> Option<String> {
        self.broken.clone()
    }
}

impl Drop for Outside {
    /// The end of its input ends the program.
    fn drop(&mut self) {
        self.pipes = None;
        if self.broken.is_some() {
            // It may not listen any more.
            let _ = self.child.kill();
        }
        let _ = self.child.wait();
    }
}

fn in_numbers(pose: &Isometry3<f64>) -> Pose {
    let (at, q) = (pose.translation.vector, pose.rotation);
    [at.x, at.y, at.z, q.w, q.i, q.j, q.k]
}

fn pose([x, y, z, w, i, j, k]: Pose) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k)))
}

#[cfg(all(test, unix))]
mod tests;
