//! Results in prose: what stands between `<!-- spliced: NAME -->` and `<!-- /spliced -->` in the README
//! and beside the reference results is taken from `results/reference/NAME`, never typed.

use std::io;
use std::path::{Component, Path, PathBuf};

const OPEN: &str = "<!-- spliced: ";
const OPEN_END: &str = " -->";
const CLOSE: &str = "<!-- /spliced -->";
const REFERENCE: &str = "results/reference";

/// What keeps a document from being spliced.
#[derive(Debug, thiserror::Error)]
pub enum CannotSplice {
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The marks do not pair.
    #[error("{}:{line}: {rule}", path.display())]
    Mark {
        /// In which document.
        path: PathBuf,
        /// On which line, from 1.
        line: usize,
        /// What is wrong.
        rule: String,
    },
}

/// A document and what it should be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Document {
    /// Relative to the root.
    pub path: PathBuf,
    /// As it is.
    pub now: String,
    /// As the results say that it should be.
    pub due: String,
}

impl Document {
    /// Whether its numbers are not those of the reference results.
    #[must_use]
    pub fn is_stale(&self) -> bool {
        self.now != self.due
    }
}

/// The README and every Markdown document under `results/reference`, in order of path, spliced anew.
/// Nothing is written.
///
/// # Errors
/// [`CannotSplice`] for the first document with a mark that cannot be filled.
pub fn documents(root: &Path) -> Result<Vec<Document>, CannotSplice> {
    let mut paths = Vec::new();
    markdown_under(root, Path::new(REFERENCE), &mut paths)?;
    paths.push(PathBuf::from("README.md"));
    paths.retain(|path| root.join(path).is_file());
    paths.sort();
    paths.into_iter().map(|path| document(root, path)).collect()
}

/// Writes the stale documents of `documents`, and gives their paths.
///
/// # Errors
/// [`CannotSplice::File`] for the first that cannot be written.
pub fn write(root: &Path, documents: &[Document]) -> Result<Vec<PathBuf>, CannotSplice> {
    let stale = documents.iter().filter(|document| document.is_stale());
    let write = |document: &Document| match std::fs::write(root.join(&document.path), &document.due) {
        Ok(()) => Ok(document.path.clone()),
        Err(source) => Err(CannotSplice::File { path: document.path.clone(), source }),
    };
    stale.map(write).collect()
}

fn markdown_under(root: &Path, folder: &Path, found: &mut Vec<PathBuf>) -> Result<(), CannotSplice> {
    let failed = |source| CannotSplice::File { path: folder.to_owned(), source };
    let entries = match std::fs::read_dir(root.join(folder)) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        entries => entries.map_err(failed)?,
    };
    for entry in entries {
        let entry = entry.map_err(failed)?;
        let path = folder.join(entry.file_name());
        if entry.file_type().map_err(failed)?.is_dir() {
            markdown_under(root, &path, found)?;
        } else if path.extension().is_some_and(|extension| extension == "md") {
            found.push(path);
        }
    }
    Ok(())
}

fn read(root: &Path, path: &Path) -> Result<String, CannotSplice> {
    std::fs::read_to_string(root.join(path)).map_err(|source| CannotSplice::File { path: path.to_owned(), source })
}

fn document(root: &Path, path: PathBuf) -> Result<Document, CannotSplice> {
    let now = read(root, &path)?;
    let (mut due, mut opened) = (String::with_capacity(now.len()), None);
    for (index, line) in now.split_inclusive('\n').enumerate() {
        let wrong = |rule: String| CannotSplice::Mark { path: path.clone(), line: index + 1, rule };
        let name = line.trim().strip_prefix(OPEN).and_then(|rest| rest.strip_suffix(OPEN_END));
        match (name, line.trim() == CLOSE, opened) {
            (Some(_), _, Some(first)) => return Err(wrong(format!("the mark of line {first} is still open"))),
            (None, true, None) => return Err(wrong(format!("`{CLOSE}` closes nothing"))),
            (Some(name), _, None) => {
                opened = Some(index + 1);
                due.push_str(line);
                due.push_str(&inset(root, name).map_err(wrong)?);
            }
            (None, true, Some(_)) => {
                opened = None;
                due.push_str(line);
            }
            (None, false, None) => due.push_str(line),
            (None, false, Some(_)) => {}
        }
    }
    match opened {
        Some(line) => Err(CannotSplice::Mark { path, line, rule: "this mark is never closed".to_owned() }),
        None => Ok(Document { path, now, due }),
    }
}

/// The command that makes `name`, and what it made.
fn inset(root: &Path, name: &str) -> Result<String, String> {
    let path = Path::new(name);
    let mut parts = path.components();
    let scenario = match parts.next() {
        Some(Component::Normal(scenario)) => scenario.to_string_lossy().into_owned(),
        _ => return Err(format!("`{name}` is no path under {REFERENCE}")),
    };
    if parts.clone().count() == 0 || !parts.all(|part| matches!(part, Component::Normal(_))) {
        return Err(format!("`{name}` is no path of the form SCENARIO/FILE under {REFERENCE}"));
    }
    let file = Path::new(REFERENCE).join(path);
    let text = read(root, &file).map_err(|error| error.to_string())?;
    let command = match (scenario.as_str(), path.file_stem()) {
        // Tables beside peers are made by the script of the same name.
        ("peers", Some(script)) => {
            format!("python3 benches/peers/{}.py --table {}", script.to_string_lossy(), file.display())
        }
        _ => format!("cargo run --bin sweep scenarios/{scenario}.toml"),
    };
    let body = match path.extension().and_then(|extension| extension.to_str()) {
        Some("md") => text.trim_matches('\n').to_owned(),
        _ => format!("```\n{}\n```", text.trim_matches('\n')),
    };
    if body.lines().any(|line| line.trim() == CLOSE || line.trim().starts_with(OPEN)) {
        return Err(format!("{} contains marks itself", file.display()));
    }
    Ok(format!("```\n{command}\n```\n\n{body}\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root(readme: &str) -> tempfile::TempDir {
        let dir = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(dir.path().join("results/reference/walk")).unwrap();
        std::fs::write(dir.path().join("results/reference/walk/table.md"), "| a |\n|---|\n| 1 |\n").unwrap();
        std::fs::write(dir.path().join("README.md"), readme).unwrap();
        dir
    }

    fn readme(root: &Path) -> Result<Document, CannotSplice> {
        documents(root).map(|all| all.into_iter().find(|it| it.path == Path::new("README.md")).unwrap())
    }

    #[test]
    fn a_table_and_its_command_stand_between_the_marks_and_nothing_else_changes() {
        let dir = root("# x\n\n<!-- spliced: walk/table.md -->\nold\n<!-- /spliced -->\n\nafter");
        let stale = documents(dir.path()).unwrap();
        assert!(stale.iter().any(Document::is_stale));
        assert_eq!(write(dir.path(), &stale).unwrap(), [Path::new("README.md")]);
        let fresh = readme(dir.path()).unwrap();
        assert!(!fresh.is_stale());
        assert_eq!(
            fresh.now,
            "# x\n\n<!-- spliced: walk/table.md -->\n```\ncargo run --bin sweep scenarios/walk.toml\n```\n\n\
             | a |\n|---|\n| 1 |\n<!-- /spliced -->\n\nafter"
        );
        std::fs::write(dir.path().join("results/reference/walk/table.md"), "| a |\n|---|\n| 2 |\n").unwrap();
        assert!(readme(dir.path()).unwrap().is_stale());
    }

    #[test]
    fn a_table_beside_peers_names_the_script_that_made_it() {
        let dir = root("<!-- spliced: peers/rays.md -->\n<!-- /spliced -->");
        std::fs::create_dir_all(dir.path().join("results/reference/peers")).unwrap();
        std::fs::write(dir.path().join("results/reference/peers/rays.md"), "| b |\n").unwrap();
        let due = readme(dir.path()).unwrap().due;
        let command = "python3 benches/peers/rays.py --table results/reference/peers/rays.md";
        assert_eq!(due, format!("<!-- spliced: peers/rays.md -->\n```\n{command}\n```\n\n| b |\n<!-- /spliced -->"));
    }

    #[test]
    fn wrong_marks_are_named_with_their_line() {
        let wrong = [
            ("\n<!-- spliced: walk/table.md -->\n", "README.md:2: this mark is never closed"),
            ("<!-- /spliced -->", "README.md:1: `<!-- /spliced -->` closes nothing"),
            (
                "<!-- spliced: walk/table.md -->\n<!-- spliced: walk/table.md -->\n",
                "README.md:2: the mark of line 1 is still open",
            ),
            ("<!-- spliced: ../secret -->\n<!-- /spliced -->", "README.md:1: `../secret` is no path under"),
            ("<!-- spliced: walk/../../x -->\n<!-- /spliced -->", "README.md:1: `walk/../../x` is no path of the form"),
            ("<!-- spliced: walk -->\n<!-- /spliced -->", "README.md:1: `walk` is no path of the form"),
            ("<!-- spliced: walk/none.md -->\n<!-- /spliced -->", "README.md:1: results/reference/walk/none.md: "),
        ];
        for (text, message) in wrong {
            let dir = root(text);
            let said = readme(dir.path()).unwrap_err().to_string();
            assert!(said.starts_with(message), "{said}");
        }
    }
}
