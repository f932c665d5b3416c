//! Cases that another program wrote: logs through the door of every data set, keys only afterwards.

use std::fs;
use std::path::{Path, PathBuf};

use asami_dataset::{Log, store};
use asami_gap::{Planted, Variant};

use super::answer::of_kind;
use super::scenario::Blind;
use super::withhold::{CASES, CannotWithhold, KEYS, Key, Unlisted, sorted};

/// A folder in the layout of `generate --withhold`.
#[derive(Clone, Debug)]
pub struct Folder {
    keys: PathBuf,
    cases: Vec<PathBuf>,
}

/// Another program's cases cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum CannotOpen {
    /// The folder cannot be read.
    #[error(transparent)]
    Folder(#[from] CannotWithhold),
    /// Nobody wrote any yet.
    #[error(
        "{} holds no cases: those of `cases_from` are another program's, to be written first (docs/blind.md and docs/engines.md \
         say how); --data DIR takes them from elsewhere",
        folder.display()
    )]
    None {
        /// The folder of cases.
        folder: PathBuf,
    },
    /// There are not so many.
    #[error("{} holds {found} cases, of which {asked} are asked for", folder.display())]
    Few {
        /// The folder of cases.
        folder: PathBuf,
        /// How many it holds.
        found: usize,
        /// How many are asked for.
        asked: usize,
    },
    /// A key cannot be read.
    #[error("cannot read the key {}: {why}", path.display())]
    Key {
        /// Its file.
        path: PathBuf,
        /// Why not.
        why: String,
    },
}

/// What a key says was planted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Opened {
    /// By the catalogue's names.
    pub planted: Vec<Planted>,
    /// What the catalogue has no name for.
    pub unlisted: Vec<Unlisted>,
}

impl Opened {
    /// The names of everything planted.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        let listed = self.planted.iter().map(|it| it.variant.about.name.to_owned());
        listed.chain(self.unlisted.iter().map(|it| it.name.clone())).collect()
    }
}

impl Folder {
    /// The cases that a blind scenario takes from another program; `None` where it draws its own.
    ///
    /// # Errors
    /// As of [`Folder::new`].
    pub fn of(blind: &Blind) -> Result<Option<Self>, CannotOpen> {
        let root = blind.asked.cases_from.as_ref();
        root.map(|root| Self::new(Path::new(root), blind.asked.cases)).transpose()
    }

    /// The first `count` cases of a folder, by their names.
    ///
    /// # Errors
    /// [`CannotOpen`] where it cannot be read, or holds none, or fewer.
    pub fn new(root: &Path, count: usize) -> Result<Self, CannotOpen> {
        let folder = root.join(CASES);
        let mut cases: Vec<PathBuf> = sorted(&folder)?.into_iter().filter(|path| path.is_dir()).collect();
        if cases.is_empty() {
            return Err(CannotOpen::None { folder });
        }
        if cases.len() < count {
            return Err(CannotOpen::Few { folder, found: cases.len(), asked: count });
        }
        cases.truncate(count);
        Ok(Self { keys: root.join(KEYS), cases })
    }

    /// The log of the `i`-th case; what else the folder of a case holds is not looked at.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn log(&self, i: usize) -> Result<Log, store::ReadError> {
        store::read(&self.cases[i]).map(|dataset| dataset.log)
    }

    /// The hash of every byte of the cases.
    ///
    /// # Errors
    /// [`CannotOpen`] where a file cannot be read.
    pub fn fingerprint(&self) -> Result<String, CannotOpen> {
        let mut hasher = blake3::Hasher::new();
        for case in &self.cases {
            for path in sorted(case)?.into_iter().filter(|path| path.is_file()) {
                let read = |source| CannotWithhold::File { path: path.clone(), source };
                let bytes = fs::read(&path).map_err(read)?;
                let name = path.strip_prefix(case).unwrap_or(&path).as_os_str().as_encoded_bytes();
                hasher.update(&(bytes.len() as u64).to_le_bytes()).update(name).update(&bytes);
            }
        }
        Ok(hasher.finalize().to_hex().to_string())
    }

    /// Opens the key of the `i`-th case.
    ///
    /// # Errors
    /// [`CannotOpen`] where there is none, or it plants what no law of the catalogue does.
    pub fn open(&self, i: usize, variants: &[Variant]) -> Result<Opened, CannotOpen> {
        let path = self.keys.join(self.cases[i].file_name().unwrap_or_default()).join("key.toml");
        let failed = |why: String| CannotOpen::Key { path: path.clone(), why };
        let text = fs::read_to_string(&path).map_err(|error| failed(error.to_string()))?;
        let key: Key = toml::from_str(&text).map_err(|error| failed(error.to_string()))?;
        let planted = key.effects.iter().map(|effect| {
            let about = effect.about();
            let values = effect.values();
            let value = |name: &str| about.parameters.iter().position(|it| it.name == name).map(|i| values[i]);
            of_kind(variants, about.name, &value)
                .ok_or_else(|| failed(format!("{} of these values is no kind of the catalogue's", about.name)))
        });
        Ok(Opened { planted: planted.collect::<Result<_, _>>()?, unlisted: key.unlisted })
    }
}
