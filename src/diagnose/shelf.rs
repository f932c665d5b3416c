//! Response libraries and planted cases, made once and kept: in a folder for each nominal world, under its hash,
//! a file for each part, so that what was stopped goes on.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

use asami_dataset::{Log, Seed};
use asami_gap::drive::{self, Drives};
use asami_gap::library::{Base, CannotLearn, Entry, Responses, play};
use asami_gap::weigh::practice::{Case, practise};
use asami_gap::{Budget, CannotPlay, Library, Planted, Variant};
use rayon::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::progress::Listener;
use super::rehearsed::Rehearsed;
use crate::scenario::{Policy, Robot, Simulation};

/// The hash of the code by which responses of robots among landmarks are learned.
const LEARNS: &str = env!("ASAMI_LEARNS");
/// The hash of the code by which those of cars are.
const LEARNS_CARS: &str = env!("ASAMI_LEARNS_CARS");
/// The hash of the code by which planted cases are weighed with them.
const WEIGHS: &str = env!("ASAMI_WEIGHS");
/// Length of the runs that stand for a world, or an effect, in its hash.
const PROBE_S: f64 = 3.0;
/// The file of the nominal response.
const NOMINAL: &str = "nominal.json";
/// The file that is locked by who adds to a folder.
const LOCK: &str = "learning.lock";
/// Digits of a hash in names.
const DIGITS: usize = 12;
/// Seeds of calibration cases begin here: no case that is scored is ever given one of them.
const FIRST_SEED: u64 = 8_000_000_000;

/// Why there is no library, or no calibration.
#[derive(Debug, thiserror::Error)]
pub enum CannotShelve {
    /// Nothing shows in the nominal world.
    #[error(transparent)]
    Learn(#[from] CannotLearn),
    /// It cannot be played.
    #[error(transparent)]
    Play(#[from] CannotPlay),
    /// A file cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// Which.
        path: PathBuf,
        /// Why not.
        source: std::io::Error,
    },
}

/// Where libraries are kept.
pub struct Shelf<'a> {
    /// The folder of all of them.
    pub folder: PathBuf,
    /// How much is played for one.
    pub budget: Budget,
    /// Hears how it goes on.
    pub listener: &'a dyn Listener,
}

/// A nominal world's library, and where it is kept.
pub struct Shelved {
    /// The library.
    pub library: Responses,
    /// The kinds of effects in it.
    pub variants: Vec<Variant>,
    /// Its folder.
    pub folder: PathBuf,
    /// Stands for all its entries, and for how cases are weighed with them.
    mark: String,
}

impl Shelved {
    /// What a log that is held against no world needs: nothing.
    #[must_use]
    pub fn unplayed(variants: &[Variant]) -> Self {
        let (folder, mark) = (PathBuf::from("none"), String::new());
        Self { library: Responses::Unplayed, variants: variants.to_vec(), folder, mark }
    }
}

impl Shelf<'_> {
    /// The library of `nominal`, called `name`, for these kinds of effects: parts that are kept are read, the others
    /// made, in parallel, and kept. Of several runs that lack the same one makes them, and the others wait for it: no task of a
    /// pool may ask for a library, lest it wait for itself.
    ///
    /// # Errors
    /// [`CannotShelve`] where the world cannot be played, shows nothing, or a file cannot be written.
    pub fn library(&self, name: &str, nominal: &Simulation, variants: &[Variant]) -> Result<Shelved, CannotShelve> {
        let nominal = &resting(nominal);
        let folder = self.folder.join(format!("{name}-{}", self.key(nominal)?));
        let places = variants.par_iter().with_max_len(1).map(|variant| {
            Ok((variant, folder.join(format!("{}-{}.json", variant.about.name, effect_key(nominal, variant)?))))
        });
        let places: Vec<(&Variant, PathBuf)> = places.collect::<Result<_, CannotShelve>>()?;
        let mark = hash(&format!("{WEIGHS} {:?}", places.iter().map(|(_, path)| path.file_name()).collect::<Vec<_>>()));
        let lacks = !folder.join(NOMINAL).exists() || places.iter().any(|(_, path)| !path.exists());
        let _turn = lacks.then(|| turn(&folder, self.listener));
        let budget = &self.budget;
        let library = if nominal.robot == Robot::Car {
            let base = self.base(&folder, || drive::Base::learn(nominal, budget))?;
            let learn = |variant: &Variant| drive::Entry::learn(nominal, &base, variant, budget);
            let entries = self.entries(&places, &learn)?;
            Responses::Drives(Box::new(Drives::new(base, entries)))
        } else {
            let base = self.base(&folder, || Base::learn(nominal, budget))?;
            let rehearsed = Rehearsed::new(nominal);
            let learn = |variant: &Variant| Entry::learn(&rehearsed, &base, variant, budget);
            let entries = self.entries(&places, &learn)?;
            Responses::Landmarks(Box::new(Library::new(base, entries)))
        };
        Ok(Shelved { library, variants: variants.to_vec(), folder, mark })
    }

    /// The nominal response, as kept in `folder` or as learned now.
    fn base<B: Serialize + DeserializeOwned>(
        &self,
        folder: &Path,
        learn: impl FnOnce() -> Result<B, CannotLearn>,
    ) -> Result<B, CannotShelve> {
        let path = folder.join(NOMINAL);
        if let Some(base) = kept(&path) {
            return Ok(base);
        }
        self.listener.says("the nominal world's response is not kept: playing it");
        let base = learn()?;
        keep(&path, &base)?;
        Ok(base)
    }

    /// What effects change, as kept or as learned now.
    fn entries<E: Serialize + DeserializeOwned + Send>(
        &self,
        places: &[(&Variant, PathBuf)],
        learn: &(dyn Fn(&Variant) -> Result<E, CannotPlay> + Sync),
    ) -> Result<Vec<E>, CannotShelve> {
        let found: Vec<Option<E>> = places.iter().map(|(_, path)| kept(path)).collect();
        let there = found.iter().filter(|entry| entry.is_some()).count();
        self.listener.begins("responses to effects", there, places.len());
        let made = places.par_iter().zip(found).with_max_len(1).map(|((variant, path), found)| match found {
            Some(entry) => Ok(entry),
            None => {
                let entry = learn(variant)?;
                keep(path, &entry)?;
                self.listener.steps();
                Ok(entry)
            }
        });
        made.collect()
    }

    /// The hash of all that the nominal response hangs on: the world's numbers and, for its code, what it does in
    /// the first seconds.
    fn key(&self, nominal: &Simulation) -> Result<String, CannotPlay> {
        let world = Simulation { duration_s: 0.0, seeds: 0, first_seed: 0, ..nominal.clone() };
        let learns = if nominal.robot == Robot::Car { LEARNS_CARS } else { LEARNS };
        // Serialising to memory fails only for maps with keys that are no strings: there are none.
        let numbers = serde_json::to_string(&(learns, &self.budget, &world)).unwrap_or_default();
        Ok(hash(&format!("{numbers}\n{}", probe(nominal, &[])?)))
    }
}

/// Of the commands of a wheeled robot so many are to stand, where what effects change is learned: what they do to its starts shows in
/// logs of robots that rest, whether or not the nominal one does.
const RESTS: f64 = 0.15;

/// The nominal world, whose robot rests now and then if it is on wheels that may turn: of a rail's no response knows starts.
fn resting(nominal: &Simulation) -> Simulation {
    let mut resting = nominal.clone();
    if let Policy::Roam(roams) = &mut resting.drive
        && roams.roaming.most_rad_per_s > 0.0
    {
        roams.roaming.rests = roams.roaming.rests.max(RESTS);
    }
    resting
}

/// The hash of all that the response to an effect hangs on beside the nominal one.
fn effect_key(nominal: &Simulation, variant: &Variant) -> Result<String, CannotPlay> {
    let planted = Planted { variant: variant.clone(), size: variant.sizes().1 };
    Ok(hash(&format!("{} {:?}\n{}", variant.name(), variant.sizes(), probe(nominal, &[planted])?)))
}

fn probe(nominal: &Simulation, planted: &[Planted]) -> Result<String, CannotPlay> {
    let dataset = play(nominal, planted, Seed(1), PROBE_S)?;
    let firings = dataset.log.firings.as_deref();
    let ranges: Vec<u8> =
        firings.iter().flat_map(|firings| firings.range_2mm.iter().flatten()).flat_map(|it| it.to_le_bytes()).collect();
    let log = Log { firings: None, ..dataset.log.clone() };
    Ok(hash(&format!("{log:?} {:?} {}", dataset.truth.track, blake3::hash(&ranges).to_hex())))
}

fn hash(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex()[..DIGITS].to_owned()
}

/// Waits until no other run adds to this folder, and keeps others from it for as long as what it returns is not dropped. `None` where
/// files cannot be locked: then others may make the same at the same time, and make it alike.
fn turn(folder: &Path, listener: &dyn Listener) -> Option<File> {
    std::fs::create_dir_all(folder).ok()?;
    let lock = File::create(folder.join(LOCK)).ok()?;
    match lock.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            listener.says(&format!("another run is adding to {}: waiting for it", folder.display()));
            lock.lock().ok()?;
        }
        Err(TryLockError::Error(_)) => return None,
    }
    Some(lock)
}

/// A part that is kept; one that cannot be read is as good as none: it is made anew.
fn kept<T: DeserializeOwned>(path: &Path) -> Option<T> {
    serde_json::from_slice(&std::fs::read(path).ok()?).ok()
}

/// Writes a part aside and renames it, so that no reader meets half of one.
fn keep<T: Serialize>(path: &Path, part: &T) -> Result<(), CannotShelve> {
    let failed = |source| CannotShelve::Write { path: path.to_owned(), source };
    let text = serde_json::to_vec(part).map_err(|error| failed(error.into()))?;
    let aside = path.with_extension(format!("{}.part", std::process::id()));
    let written = path.parent().map_or(Ok(()), std::fs::create_dir_all);
    written.and_then(|()| std::fs::write(&aside, text)).and_then(|()| std::fs::rename(&aside, path)).map_err(failed)
}

impl Shelved {
    /// Planted cases that are kept, of logs of about this length; `most` of them are made first, as far as they are
    /// not there.
    ///
    /// # Errors
    /// [`CannotShelve`] where a case cannot be simulated, or not be written.
    pub fn cases(
        &self,
        nominal: &Simulation,
        length_s: f64,
        make: usize,
        listener: &dyn Listener,
    ) -> Result<Vec<Case>, CannotShelve> {
        let length_s = class_s(length_s);
        let folder = self.folder.join(format!("cases-{length_s}s-{}", self.mark));
        let path = |number: usize| folder.join(format!("{number:04}.json"));
        let missing = || (1..=make).filter(|number| !path(*number).exists()).collect::<Vec<_>>();
        if !missing().is_empty() {
            let _turn = turn(&folder, listener);
            // Another run may have made them meanwhile.
            let missing = missing();
            listener.begins("planted cases", make - missing.len(), make);
            missing.into_par_iter().with_max_len(1).try_for_each(|number| {
                let seed = Seed(FIRST_SEED + number as u64);
                let cases = practise(nominal, &self.library, &self.variants, seed, length_s)?;
                keep(&path(number), &cases)?;
                listener.steps();
                Ok::<(), CannotShelve>(())
            })?;
        }
        let made = (1..).map(path).take_while(|path| path.exists());
        Ok(made.filter_map(|path| kept::<Vec<Case>>(&path)).flatten().collect())
    }
}

/// Lengths of planted logs: a log's own is rounded to one of these, by ratio.
const CLASSES_S: [f64; 5] = [60.0, 150.0, 300.0, 600.0, 900.0];

fn class_s(length_s: f64) -> f64 {
    let off = |class_s: f64| (class_s / length_s.max(1.0)).max(length_s.max(1.0) / class_s);
    CLASSES_S.into_iter().reduce(|a, b| if off(b) < off(a) { b } else { a }).unwrap_or(length_s)
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;
    use std::time::Duration;

    use asami_gap::weigh::causes::Evidence;

    use super::*;
    use crate::scenario::{self, Origin};

    fn case(truth: &str) -> Case {
        let evidence = [("a", 5.0), ("b", 1.0), ("a+b", 6.0), ("unknown/timing", 2.0)];
        let evidence = Evidence::from(evidence.map(|(cause, nats)| (cause.to_owned(), nats)));
        Case { truth: truth.to_owned(), shown: None, evidence, absorbed_nats: Some(0.1), off_by: None }
    }

    #[test]
    fn robots_that_may_turn_rest_where_responses_are_learned() {
        let rests = |text: &str| {
            let Origin::Simulated(nominal) = scenario::parse("create", "create.toml", text).unwrap().origin else {
                panic!("it is simulated")
            };
            let Policy::Roam(roams) = resting(&nominal).drive else { panic!("it roams") };
            roams.roaming.rests
        };
        let create = include_str!("../../scenarios/create.toml");
        assert_eq!(rests(create), RESTS);
        assert_eq!(rests(&create.replace("[roam]\n", "[roam]\nrests = 0.4\n")), 0.4);
        assert_eq!(rests(include_str!("../../scenarios/create_rail.toml")), 0.0);
    }

    #[test]
    fn lengths_are_rounded_by_ratio() {
        assert_eq!([1.0, 90.0, 150.0, 400.0, 5e3].map(class_s), [60.0, 60.0, 150.0, 300.0, 900.0]);
    }

    #[test]
    fn what_is_kept_is_read_back_and_what_is_torn_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/0001.json");
        assert_eq!(kept::<Case>(&path), None);
        keep(&path, &case("a")).unwrap();
        assert_eq!(kept::<Case>(&path), Some(case("a")));
        std::fs::write(&path, "{\"truth\": \"a\", \"evi").unwrap();
        assert_eq!(kept::<Case>(&path), None);
        assert_eq!(std::fs::read_dir(folder.path().join("deep")).unwrap().count(), 1);
    }

    /// Who comes second waits until the first is done, and says so.
    #[test]
    fn one_run_at_a_time_adds_to_a_folder() {
        struct Heard(mpsc::Sender<String>);
        impl Listener for Heard {
            fn begins(&self, _: &str, _: usize, _: usize) {}
            fn steps(&self) {}
            fn says(&self, line: &str) {
                self.0.send(line.to_owned()).unwrap();
            }
        }
        let folder = tempfile::tempdir().unwrap();
        let (heard, lines) = mpsc::channel();
        let first = turn(folder.path(), &Heard(heard.clone())).unwrap();
        let (done, ends) = mpsc::channel();
        std::thread::scope(|scope| {
            scope.spawn(|| done.send(turn(folder.path(), &Heard(heard)).is_some()).unwrap());
            assert!(lines.recv().unwrap().contains("waiting for it"));
            assert!(ends.recv_timeout(Duration::from_millis(100)).is_err(), "it did not wait");
            drop(first);
            assert!(ends.recv().unwrap());
        });
        assert!(lines.try_recv().is_err(), "the first had nobody to wait for");
    }
}
