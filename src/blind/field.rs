//! The diagnosers themselves, and the likelihood by which they and the referee judge.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use asami_dataset::Log;
use asami_gap::answer::calibration::{Calibration, less};
use asami_gap::answer::experiment::Courses;
use asami_gap::answer::rivals::{AllAtOnce, ForwardSelection};
use asami_gap::weigh::practice::Case;
use asami_gap::{Budget, CannotDiagnose, Diagnoser, Diagnoses, Diagnosis, Judges, Variant};

use super::next::Driven;
use super::scenario::Blind;
use super::walk::Contest;
use crate::diagnose::courses::Played;
use crate::diagnose::progress::Listener;
use crate::diagnose::shelf::{CannotShelve, Shelf, Shelved};

/// All that take part in a blind sweep.
pub struct Field<'a> {
    blind: &'a Blind,
    shelf: Shelf<'a>,
    shelved: Shelved,
    cases: Vec<Case>,
    /// Where the next experiment is asked for.
    courses: Option<Played>,
    /// By what is taken out of the list: to learn one takes longer than to diagnose a log.
    calibrations: Mutex<BTreeMap<Vec<String>, Calibration>>,
}

impl<'a> Field<'a> {
    /// The library and the calibration cases for a blind scenario: those that are kept in `libraries` are read, the others
    /// made there.
    ///
    /// # Errors
    /// [`CannotShelve`] where the nominal world cannot be played, or a file not be written.
    pub fn new(blind: &'a Blind, libraries: &Path, listener: &'a dyn Listener) -> Result<Self, CannotShelve> {
        let on: Vec<String> = blind.world.effects.iter().map(|effect| effect.about().name.to_owned()).collect();
        let variants = Variant::all(blind.world.robot.name(), blind.world.field.beacons.len(), &on);
        let shelf = Shelf { folder: libraries.to_owned(), budget: Budget::of(blind.world.robot.name()), listener };
        let shelved = shelf.library(&blind.nominal, &blind.world, &variants)?;
        let make = blind.asked.calibration_cases;
        let mut cases = Vec::new();
        if make > 0 {
            cases = shelved.cases(&blind.world, blind.world.duration_s, make, listener)?;
        }
        let courses = blind.asked.next_experiment.then(|| Played::new(&blind.world, blind.world.duration_s));
        courses.iter().for_each(Played::play_ahead);
        let field = Self { blind, shelf, shelved, cases, courses, calibrations: Mutex::default() };
        field.calibrated(&[]);
        Ok(field)
    }

    /// The calibration with these effects taken out of the list.
    fn calibrated(&self, without: &[String]) -> Calibration {
        let kept = || self.calibrations.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = kept().get(without) {
            return known.clone();
        }
        // Nobody waits meanwhile: two that learn the same learn it alike.
        let learned = Calibration::of(&less(&self.cases, without));
        kept().insert(without.to_vec(), learned.clone());
        learned
    }
}

/// Ours, with a catalogue and a calibration of its own.
struct Ours<'a> {
    field: &'a Field<'a>,
    calibration: Calibration,
    variants: Vec<Variant>,
}

impl Diagnoses for Ours<'_> {
    fn name(&self) -> &str {
        "asami"
    }

    fn diagnose(&self, log: &Log) -> Result<Diagnosis, CannotDiagnose> {
        let library = &self.field.shelved.library;
        let courses: &dyn Courses = self.field.courses.as_ref().map_or(&(), |played| played);
        let diagnoser = Diagnoser { library, calibration: &self.calibration, variants: &self.variants, courses };
        Diagnoses::diagnose(&diagnoser, log)
    }
}

impl Contest for Field<'_> {
    fn judges(&self) -> &dyn Judges {
        &self.shelved.library
    }

    fn variants(&self) -> &[Variant] {
        &self.shelved.variants
    }

    fn diagnosers(&self, without: &[String]) -> Vec<Box<dyn Diagnoses + '_>> {
        let is_in = |variant: &&Variant| !without.iter().any(|name| name == variant.about.name);
        let variants: Vec<Variant> = self.shelved.variants.iter().filter(is_in).cloned().collect();
        let judges: &dyn Judges = &self.shelved.library;
        let rivals = &self.blind.asked.rivals;
        let of = |name: &String| -> Box<dyn Diagnoses + '_> {
            let variants = variants.clone();
            match name.as_str() {
                "all_at_once" => {
                    let evaluations = rivals.evaluations as usize;
                    Box::new(AllAtOnce { judges, variants, evaluations })
                }
                "forward_selection" => {
                    Box::new(ForwardSelection { judges, variants, most: rivals.most_effects as usize })
                }
                _ => Box::new(Ours { field: self, calibration: self.calibrated(without), variants }),
            }
        };
        self.blind.asked.diagnosers.iter().map(of).collect()
    }

    fn driven(&self, keys: &str) -> Result<Option<Driven<'_>>, CannotShelve> {
        let Some(world) = self.courses.as_ref().and_then(|played| played.driven(keys)) else { return Ok(None) };
        let shelved = self.shelf.library(&self.blind.nominal, &world, &self.shelved.variants)?;
        Ok(Some(Driven { world, judges: Box::new(shelved.library) }))
    }

    fn fingerprint(&self) -> String {
        // Debug shows every number by its shortest round trip: what differs at all differs here.
        let all = format!("{:?} {:?}", self.shelved.library, self.cases);
        blake3::hash(all.as_bytes()).to_hex().to_string()
    }
}
