//! `cargo run --bin diagnose DATASET`: where a log and a simulator part, which effect parts them, and how far the gap
//! shrinks with it.

use std::path::PathBuf;
use std::process::ExitCode;

use asami::diagnose::progress::{Listener, Progress};
use asami::diagnose::self_test::self_test;
use asami::diagnose::{Answer, Asked, kin, words};
use asami::real::odometry::Readied;
use asami::verb;
use asami_gap::real::Search;
use clap::Parser;

/// Says where a log and its nominal world part, which unmodelled effect parts them, and how far the gap shrinks with it.
///
/// The answer goes to stdout and, with a report and the repaired scenario, to DIR. What the nominal world and each effect do
/// is played once and kept.
#[derive(Parser)]
#[command(
    version,
    after_help = "Examples:
  generate scenarios/plain_2d.toml --seed 1000 --duration-s 150 --effect image_delay.delay_s=0.06 -o results/late
  diagnose results/late
  diagnose results/late --without image_delay
  sweep results/diagnosis/late/with_effect.toml

Exit status: 0 done, 1 our bug, 2 bad input, or a log that shows nothing."
)]
struct Arguments {
    /// The data set's folder
    dataset: PathBuf,
    /// The scenario, a file or the name of a shipped one, whose world the log is held against [default: the one that
    /// the data set names, else the one shipped for its robot]
    #[arg(long, value_name = "SCENARIO")]
    nominal: Option<PathBuf>,
    /// Takes an effect out of the catalogue; may be given again
    #[arg(long, value_name = "EFFECT")]
    without: Vec<String>,
    /// Where the answer goes [default: results/diagnosis/DATASET]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Plants N cases in the nominal world [default: 30], and says how often effects are named and their sizes covered
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true, default_missing_value = "30")]
    self_test: Option<u16>,
    /// Calibrates probabilities on at least so many planted cases, which are made once and kept; 0: none, and
    /// probabilities are too bold [default: 300, of a robot in Rapier 75]
    #[arg(long, value_name = "N")]
    calibrate: Option<usize>,
    /// The log is of a real robot: how noisy it is where it is diagnosed, is learned from the other half of the log, in pieces
    /// by turns; effects are named one beside another, the most evident first, for as long as they explain more. Of a car: its laser
    /// scanner is held against the table of its own lasers, by its scans alone
    #[arg(long)]
    real: bool,
    /// Of a real log, odometry that is noisy at each reading stands in for commands: it is averaged over S seconds
    #[arg(long, value_name = "S", requires = "real")]
    average_s: Option<f64>,
    /// Of a real log, odometry stands in for commands, and a reading is of the time before it: S seconds earlier it was commanded
    #[arg(long, value_name = "S", requires = "real")]
    earlier_s: Option<f64>,
    /// Of a real log, the camera takes N pictures a second by a clock of its own, and what is seen is dated by when the newest is
    /// picked up: it is taken back to when it was seen, where the log tells
    #[arg(long, value_name = "N", requires = "real")]
    camera_hz: Option<f64>,
    /// Of a real log, commands are taken up once in a cycle of about S seconds, and the newest is in force until the next: they are given
    /// as they were taken up, where the log tells
    #[arg(long, value_name = "S", requires = "real")]
    command_cycle_s: Option<f64>,
    /// Of a real log, what is seen of a landmark within S seconds is put together, at the mean of their times, but for what is seen before
    /// or after commands change
    #[arg(long, value_name = "S", requires = "real")]
    points_s: Option<f64>,
    /// Of a real log's frames, which are off alike where they follow at once, one in S seconds is taken
    #[arg(long, value_name = "S", requires = "real")]
    every_s: Option<f64>,
    /// Of a real robot, effects are found both one after another, and backwards from all of them at once; what is worth more counts: of
    /// effects that act alike the one that comes first may make up for the others. Takes about half as long again
    #[arg(long, requires = "real")]
    both_ways: bool,
    /// Of a real robot, halves of the log are diagnosed first, each by itself: by how much they differ by more than they are said to, so
    /// much less is said for sure of the whole
    #[arg(long, requires = "real")]
    by_halves: bool,
    /// Of a real robot, the diagnosis.json of another of its make, by its own log: what others have, it is expected to have, and what
    /// none of them has, it is not; may be given again
    #[arg(long, value_name = "FILE", requires = "real")]
    kin: Vec<PathBuf>,
    /// Where what was played is kept
    #[arg(long, value_name = "DIR", default_value = "results/library")]
    libraries: PathBuf,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    verb::main(|| {
        let Arguments { average_s, earlier_s, camera_hz, command_cycle_s, points_s, every_s, .. } = arguments;
        let readied = Readied { average_s, earlier_s, camera_hz, command_cycle_s, points_s, every_s };
        if let Some((key, message)) = readied.faults().first() {
            miette::bail!("--{}: {message}", key.replace('_', "-"));
        }
        let (log, clocks) = readied.of(&verb::dataset(&arguments.dataset)?.log);
        let folder = arguments.dataset.canonicalize().unwrap_or_else(|_| arguments.dataset.clone());
        let name = folder.file_name().map_or_else(|| "log".to_owned(), |name| name.to_string_lossy().into_owned());
        let asked = Asked {
            nominal: arguments.nominal,
            without: arguments.without,
            libraries: arguments.libraries,
            budget: None,
            calibrate: arguments.calibrate,
            real: arguments.real,
            kin: kin::read(&arguments.kin)?,
            by_halves: arguments.by_halves,
            search: Search::of(arguments.both_ways),
            picture_period_s: clocks.picture_period_s,
            command_cycle_s: clocks.command_cycle_s,
            notes: clocks.said,
        };
        let listener = Progress::default();
        let (answer, ready) = Answer::new(&log, &asked, &listener)?;
        verb::print(&words::text(&answer.diagnosis));
        let out = arguments.output.unwrap_or_else(|| PathBuf::from("results/diagnosis").join(&name));
        answer.write(&name, &ready, &out)?;
        listener.says(&format!("written to {}", out.display()));
        if let Some(cases) = arguments.self_test {
            verb::print(&self_test(&ready, answer.length_s, cases.into(), &listener).map_err(verb::plain)?.text());
        }
        Ok(verb::Ending::Done)
    })
}
