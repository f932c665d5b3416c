//! Cases on disk: logs in one folder, what is in them in another.

use std::fs::{self, File, FileTimes};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, SystemTime};

use asami_dataset::{Dataset, Log, Truth, store};
use asami_sim::effects::Effects;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Mix, Planting};
use crate::simulate::CannotSimulate;

/// Folder of the logs.
pub const CASES: &str = "cases";
/// Folder of what is in them.
pub const KEYS: &str = "keys";
/// The times of every file of a case: those at which it was made would tell how long it took.
const MADE: Duration = Duration::from_secs(1_000_000_000);

/// `keys/NNN/key.toml`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Key {
    /// Version of the form.
    pub schema: u32,
    /// The scenario whose world is the nominal one.
    pub nominal: String,
    /// Length of the log.
    pub duration_s: f64,
    /// The seed of commands, start and noise.
    pub seed: u64,
    /// What another program planted that the catalogue has no name for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unlisted: Vec<Unlisted>,
    /// What was planted beside the nominal world's own effects.
    #[serde(default)]
    pub effects: Effects,
}

/// An effect that the catalogue has no name for: the right answer is *unknown*.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Unlisted {
    /// In its planter's words.
    pub name: String,
    /// Where it acts: `actuation`, `dynamics`, `sensing` or `scene`.
    pub place: String,
    /// Which flexible block it shows in: `static_motion`, `timing`, `drift`, `sensor` or `noise`.
    pub block: String,
    /// How large it is, in its planter's unit.
    pub size: f64,
}

/// `keys/salt.toml`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Salted {
    salt: String,
    cases: usize,
    mix: Mix,
}

/// What kept cases from being written.
#[derive(Debug, thiserror::Error)]
pub enum CannotWithhold {
    /// Older cases would be mixed with the new ones.
    #[error("{} is there already: remove it, or give another folder", .0.display())]
    Occupied(PathBuf),
    /// A world cannot be built.
    #[error(transparent)]
    Simulate(#[from] CannotSimulate),
    /// A data set cannot be written.
    #[error(transparent)]
    Write(#[from] store::WriteError),
    /// Another file cannot.
    #[error("cannot write {}: {source}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// Why not.
        source: std::io::Error,
    },
    /// A key cannot be put in words.
    #[error("cannot write a key: {0}")]
    Key(#[from] toml::ser::Error),
}

fn file(path: &Path) -> impl FnOnce(std::io::Error) -> CannotWithhold {
    let path = path.to_owned();
    move |source| CannotWithhold::File { path, source }
}

/// Writes `count` cases of `planting` under `out`: `cases/NNN/` with nothing but the log, `keys/NNN/` with what
/// is in it and where the robot was. `heard` is told how many are done.
///
/// # Errors
/// [`CannotWithhold`] where there are cases already, a world cannot be built, or a file not be written.
pub fn withhold(
    planting: &Planting,
    scenario: &str,
    count: usize,
    out: &Path,
    heard: &(dyn Fn(usize) + Sync),
) -> Result<(), CannotWithhold> {
    let (cases, keys, making) = (out.join(CASES), out.join(KEYS), out.join(".making"));
    for folder in [&cases, &keys, &making] {
        if folder.exists() {
            return Err(CannotWithhold::Occupied(folder.clone()));
        }
    }
    let width = count.to_string().len().max(3);
    let done = AtomicUsize::new(0);
    (0..count).into_par_iter().with_max_len(1).try_for_each(|i| {
        let case = planting.case(1 + i);
        let Dataset { log, truth, .. } = planting.simulate(&case, scenario)?;
        let name = format!("{:0width$}", case.number);
        let key = Key {
            schema: 1,
            nominal: scenario.to_owned(),
            duration_s: planting.nominal.duration_s,
            seed: case.seed.0,
            unlisted: Vec::new(),
            effects: case.effects(),
        };
        write_key(&key, &log, truth, &keys.join(&name))?;
        store::write(&Dataset { log, truth: Truth::default(), provenance: None }, &making.join(&name))?;
        heard(1 + done.fetch_add(1, Ordering::Relaxed));
        Ok::<(), CannotWithhold>(())
    })?;
    let salted = Salted { salt: planting.salt.clone(), cases: count, mix: planting.mix.clone() };
    let path = keys.join("salt.toml");
    fs::create_dir_all(&keys).map_err(file(&keys))?;
    fs::write(&path, toml::to_string(&salted)?).map_err(file(&path))?;
    publish(&making, &cases)?;
    fs::remove_dir_all(&making).map_err(file(&making))
}

/// The key with the truth as a data set would have it, and no log.
fn write_key(key: &Key, log: &Log, truth: Truth, folder: &Path) -> Result<(), CannotWithhold> {
    let bare = Log { known: log.known.clone(), ..Log::default() };
    store::write(&Dataset { log: bare, truth, provenance: None }, folder)?;
    let path = folder.join("key.toml");
    fs::write(&path, toml::to_string(key)?).map_err(file(&path))
}

/// Copies the logs in order and in one go: a file's own times, even that of its birth, which nobody can set, then
/// tell nothing of how long a world took.
fn publish(making: &Path, cases: &Path) -> Result<(), CannotWithhold> {
    fs::create_dir_all(cases).map_err(file(cases))?;
    for from in sorted(making)? {
        let to = cases.join(from.file_name().unwrap_or_default());
        fs::create_dir_all(&to).map_err(file(&to))?;
        for part in sorted(&from)? {
            let copy = to.join(part.file_name().unwrap_or_default());
            fs::copy(&part, &copy).map_err(file(&copy))?;
            backdate(&copy).map_err(file(&copy))?;
        }
        // Only where a folder can be opened like a file.
        if cfg!(unix) {
            backdate(&to).map_err(file(&to))?;
        }
    }
    Ok(())
}

pub(super) fn sorted(folder: &Path) -> Result<Vec<PathBuf>, CannotWithhold> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries.collect::<Result<Vec<_>, _>>().map_err(file(folder))?,
        // No case, no folder.
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Vec::new(),
        Err(error) => return Err(file(folder)(error)),
    };
    let mut paths: Vec<PathBuf> = entries.into_iter().map(|entry| entry.path()).collect();
    paths.sort();
    Ok(paths)
}

fn backdate(path: &Path) -> std::io::Result<()> {
    let made = SystemTime::UNIX_EPOCH + MADE;
    let open = if path.is_dir() { File::open(path)? } else { File::options().write(true).open(path)? };
    open.set_times(FileTimes::new().set_accessed(made).set_modified(made))
}
