//! Lets the Aibo pace before a beacon for long and prints how it fared: falls, heading, how much it sees, how well
//! its speed repeats, how it creeps when told to stand, and how fast all that was computed.
//!
//! ```text
//! cargo run --example pacing            # 15 logs of 300 s
//! cargo run --example pacing -- 3 60    # 3 of 60 s
//! cargo run --example pacing -- 15 300 full_lift_speed_m_per_s=0.15 near_height_px=37 far_height_px=10.9 strata=3
//! ```
//!
//! Further arguments set parameters of the gait and of the policy: those above are of `scenarios/aibo_1d.toml`.

use std::error::Error;
use std::time::Instant;

use asami_dataset::parameters::Parameters;
use asami_dataset::{Rng, Seed, TruePose};
use asami_math::angle::wrap_rad;
use asami_sim::drives::hold::Hold;
use asami_sim::drives::pace::{Pace, Pacing};
use asami_sim::effects::Effects;
use asami_sim::robots::aibo::{AiboConfig, AiboWorld, BuildError, Start};
use asami_sim::scenes::field::{Colour, Cylinder, Field, Landmark};
use asami_sim::sensors::camera::CameraConfig;
use asami_sim::world::{Drive, Record, World, run};
use rand::RngExt;

/// Seeds below 1000 belong to the experiments.
const FIRST_SEED: u64 = 1000;
/// The beacon stands this far along y.
const BEACON_M: f64 = 10.0;
/// Speeds are timed over this length.
const LENGTH_M: f64 = 4.2;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let logs: u64 = arguments.next().map_or(Ok(15), |text| text.parse())?;
    let until_s: f64 = arguments.next().map_or(Ok(300.0), |text| text.parse())?;
    let mut walk = Walk::default();
    for argument in arguments {
        walk.set(&argument)?;
    }
    let begun = Instant::now();
    println!("seed  fallen  greatest bearing deg  nearest m  farthest m  frames with the beacon %");
    for seed in (FIRST_SEED..FIRST_SEED + logs).map(Seed) {
        walk.pace(seed, until_s)?;
    }
    let simulated_s = logs as f64 * until_s;
    println!("{:.0} times real time", simulated_s / begun.elapsed().as_secs_f64());

    println!("command mm/s  speed mm/s  sd over ten timings of {LENGTH_M} m");
    for command_m_per_s in [-0.3, -0.2, -0.1, 0.1, 0.2, 0.3] {
        let speeds =
            (0..10).map(|i| walk.timed(command_m_per_s, Seed(FIRST_SEED + i))).collect::<Result<Vec<_>, _>>()?;
        let mean = speeds.iter().sum::<f64>() / speeds.len() as f64;
        let var = speeds.iter().map(|speed| (speed - mean) * (speed - mean)).sum::<f64>() / (speeds.len() - 1) as f64;
        println!("{:12.0} {:11.1} {:8.2}", 1e3 * command_m_per_s, 1e3 * mean, 1e3 * var.sqrt());
    }
    let stood = run(&mut *walk.world(0.0, Seed(FIRST_SEED))?, &mut Hold::forward(0.0), 60.0).truth.track;
    if let [first, .., last] = &stood[..] {
        println!("standing drifts by {:.3} mm/s", 1e3 * (last.x_m - first.x_m).hypot(last.y_m - first.y_m) / 60.0);
    }
    Ok(())
}

/// How it walks, and by which policy.
#[derive(Default)]
struct Walk {
    aibo: AiboConfig,
    pacing: Pacing,
}

impl Walk {
    /// Sets a parameter of the gait or of the policy: `NAME=VALUE`.
    fn set(&mut self, argument: &str) -> Result<(), Box<dyn Error>> {
        let (name, value) = argument.split_once('=').ok_or("an argument that is no NAME=VALUE")?;
        let value = value.parse()?;
        if self.aibo.gait.set(name, value) || self.pacing.set(name, value) {
            return Ok(());
        }
        Err(format!("neither the gait nor the policy has a parameter {name}").into())
    }

    /// The robot at `y_m`, facing the beacon, anywhere in its stride.
    fn world(&self, y_m: f64, seed: Seed) -> Result<Box<AiboWorld>, BuildError> {
        let body = Cylinder {
            x_m: 0.0,
            y_m: BEACON_M,
            radius_m: 0.05,
            base_m: 0.1,
            height_m: 0.2,
            bands: [Colour::Pink, Colour::Yellow],
        };
        let field = Field { beacons: vec![Landmark { id: 0, body }], clutter: vec![] };
        let mut rng: Rng = seed.stream("start");
        let start = Start { y_m, gait_phase: rng.random(), ..Start::default() };
        AiboWorld::new(&self.aibo, &field, &CameraConfig::default(), &Effects::default(), start, seed).map(Box::new)
    }

    fn pace(&self, seed: Seed, until_s: f64) -> Result<(), BuildError> {
        let mut world = self.world(BEACON_M - 2.4, seed)?;
        let paced = run(&mut *world, &mut Pace::new(self.pacing.clone(), seed.stream("drive")), until_s);
        let from_beacon = |pose: &TruePose| (-pose.x_m, BEACON_M - pose.y_m);
        let (mut greatest_rad, mut nearest_m, mut farthest_m) = (0.0_f64, f64::MAX, 0.0_f64);
        for pose in paced.truth.track.iter() {
            let (dx, dy) = from_beacon(pose);
            greatest_rad = greatest_rad.max(wrap_rad((-dx).atan2(dy) - pose.theta_rad).abs());
            nearest_m = nearest_m.min(dx.hypot(dy));
            farthest_m = farthest_m.max(dx.hypot(dy));
        }
        let frames = paced.log.frames.as_deref().map_or(0, <[_]>::len);
        println!(
            "{:4}  {:6} {:21.1} {:10.2} {:11.2} {:10.1}",
            seed.0,
            world.has_fallen(),
            greatest_rad.to_degrees(),
            nearest_m,
            farthest_m,
            100.0 * paced.log.sightings.len() as f64 / frames as f64
        );
        Ok(())
    }

    /// Mean speed over [`LENGTH_M`] of walking at one command, from a second after the start.
    fn timed(&self, command_m_per_s: f64, seed: Seed) -> Result<f64, BuildError> {
        let mut world = self.world(if command_m_per_s > 0.0 { BEACON_M - 6.0 } else { BEACON_M - 1.2 }, seed)?;
        let mut record = Record::default();
        let mut drive = Hold::forward(command_m_per_s);
        let mut first: Option<TruePose> = None;
        loop {
            let action = drive.act(world.t_s(), &record.seen);
            world.tick(action, &mut record);
            let now = world.pose();
            let Some(first) = first else {
                first = (now.t_s >= 1.0).then_some(now);
                continue;
            };
            let walked_m = now.y_m - first.y_m;
            if walked_m.abs() >= LENGTH_M || now.t_s > 300.0 {
                return Ok(walked_m / (now.t_s - first.t_s));
            }
        }
    }
}
