//! Chapter 5's drive: a car with a Velodyne on its roof, driven through a town of its own.

use std::sync::Arc;

use crate::drives::driver::{Driver, Driving, Feel};
use crate::effects::Effects;
use crate::robots::car::{BuildError, CarConfig, CarWorld};
use crate::scenes::town::{Town, TownConfig};
use crate::sensors::applanix::Applanix;
use crate::sensors::velodyne::{Scenery, TrackError, Unit, Velodyne, VelodyneConfig};
use crate::world;
use asami_dataset::log::Velodyne as KnownVelodyne;
use asami_dataset::parameters::{Fault, Parameters};
use asami_dataset::{Dataset, Seed, Survey};
use serde::{Deserialize, Serialize};

/// Of the scanner over the road, the car standing.
const SENSOR_HEIGHT_M: f64 = 2.0;

/// Why a laser scanner saw nothing of a drive.
#[derive(Debug, thiserror::Error)]
pub enum CannotScan {
    /// The town's triangles have no meaning.
    #[error("the town cannot be scanned: {0}")]
    Scenery(String),
    /// The drive says too little of where the scanner was.
    #[error("the drive cannot be scanned: {0}")]
    Track(#[from] TrackError),
}

/// Why there is no drive.
#[derive(Debug, thiserror::Error)]
pub enum CannotRide {
    /// The car cannot be built.
    #[error(transparent)]
    Car(#[from] BuildError),
    /// Its laser scanner sees nothing.
    #[error(transparent)]
    Scan(#[from] CannotScan),
}

/// Where the lasers of a scanner point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Angles {
    /// As those of the dissertation's car: every drive has the same unit.
    #[default]
    Art,
    /// Horizontal angles drawn anew for each drive, evenly from the same range.
    Redrawn,
}

/// A town, a car, who drives it, and what is recorded.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Ride {
    /// The town.
    pub town: TownConfig,
    /// The car.
    pub car: CarConfig,
    /// The driver.
    pub driving: Driving,
    /// The laser scanner.
    pub velodyne: VelodyneConfig,
    /// Where its lasers point.
    pub unit: Angles,
    /// What published errors are measured with.
    pub applanix: Applanix,
}

impl Ride {
    /// Adds a fault for every value out of range, and where values do not fit each other.
    pub fn check(&self, faults: &mut Vec<Fault>) {
        self.town.check_fit("town", faults);
        self.car.check("car", faults);
        self.driving.check("driving", faults);
        self.velodyne.check("velodyne", faults);
        self.applanix.check("applanix", faults);
        let pairs = [
            ("driving", "most_wait_s", self.driving.most_wait_s, "least_wait_s", self.driving.least_wait_s),
            (
                "velodyne",
                "greatest_range_m",
                self.velodyne.greatest_range_m,
                "least_range_m",
                self.velodyne.least_range_m,
            ),
        ];
        for (table, most_name, most, least_name, least) in pairs {
            if most < least {
                let message = format!("{most_name} must not be below {least_name} {least}, not {most}");
                faults.push(Fault { path: format!("{table}.{most_name}"), message });
            }
        }
    }

    /// The town of a drive.
    #[must_use]
    pub fn town(&self, seed: Seed) -> Town {
        Town::new(&self.town, seed)
    }

    /// The car at the beginning of a town's route.
    ///
    /// # Errors
    /// If it cannot be built.
    pub fn on(&self, town: &Town, effects: &Effects, seed: Seed) -> Result<CarWorld, BuildError> {
        let known = KnownVelodyne {
            vertical_angles_rad: self.unit(seed).lasers().iter().map(|laser| laser.vertical_rad).collect(),
            firing_rate_hz: self.velodyne.firing_rate_hz,
            turn_rate_hz: self.velodyne.turn_rate_hz,
            sensor_height_m: SENSOR_HEIGHT_M,
            left_m: Vec::new(),
            up_m: Vec::new(),
        };
        CarWorld::new(&self.car, &town.ground(), Some(known), effects, town.route.at(0.0).into(), seed)
    }

    /// Who drives it along the town's route.
    #[must_use]
    pub fn driver(&self, town: &Town, seed: Seed) -> Driver {
        Driver::new(self.driving.clone(), Feel::of(self.car.body), town.route.clone(), 0.0, seed.stream("drive"))
    }

    fn unit(&self, seed: Seed) -> Unit {
        match self.unit {
            Angles::Art => Unit::art(),
            Angles::Redrawn => Unit::art().redrawn(&mut seed.stream("unit")),
        }
    }

    /// A drive with everything that was fired, where the car was, and the lasers' true angles.
    ///
    /// # Errors
    /// If the car cannot be built, or its scanner sees nothing.
    pub fn dataset(&self, effects: &Effects, until_s: f64, seed: Seed) -> Result<Dataset, CannotRide> {
        let town = self.town(seed);
        let mut car = self.on(&town, effects, seed)?;
        let mut driver = self.driver(&town, seed);
        let mut record = world::record(&mut car, &mut driver, until_s);
        let poses = std::mem::take(&mut record.sensor_poses);
        let mut dataset = world::dataset(&car, record);
        let reflectivity = |i: usize| town.surface.get(i).map_or(0.0, |surface| surface.reflectivity());
        let scenery = Scenery::new(&town.vertices, &town.triangles, reflectivity)
            .map_err(|error| CannotScan::Scenery(error.to_string()))?;
        let velodyne = Velodyne::new(self.velodyne.clone(), self.unit(seed))
            .under(effects, seed)
            .among(town.traffic(effects, seed));
        let firings = velodyne.scan(&scenery, &poses, seed).map_err(CannotScan::Track)?;
        dataset.log.firings = Some(Arc::new(firings));
        dataset.truth.survey = Some(Survey {
            horizontal_angles_rad: velodyne.horizontal_angles_rad(),
            theta_b_rad: Some(self.velodyne.base_rad),
            ..Survey::default()
        });
        Ok(dataset)
    }
}
