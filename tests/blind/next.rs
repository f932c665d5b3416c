//! What is recorded next: in the true world, as advised and again, and asked of the two that were tied.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use asami::blind::next::{Driven, Next};
use asami::blind::scenario::{Measure, parse};
use asami::blind::tally::{asked, measure};
use asami::blind::walk::{Contest, Results, run};
use asami::diagnose::shelf::CannotShelve;
use asami::report;
use asami::scenario::{Policy, Simulation};
use asami::sweep::Silent;
use asami_dataset::Log;
use asami_gap::answer::diagnosis::{Cause, Verdict};
use asami_gap::{CannotDiagnose, Diagnoses, Diagnosis, Judges, Likelihood, Planted, Variant};
use asami_sim::drives::explore::Exploring;

use super::{ASKED, PLAIN, blind, options};

/// Logs as advised go on for longer than others, by which they are known here.
const ADVISED_S: f64 = 30.0;

/// By so many nats a log speaks for a delay over everything else.
struct ForDelay(f64);

impl Likelihood for ForDelay {
    fn blocks(&self, effects: &[Planted]) -> Vec<f64> {
        let is_delay = effects.iter().any(|it| it.variant.about.name == "command_delay");
        vec![if is_delay { self.0 } else { 0.0 }]
    }

    fn observations(&self) -> usize {
        100
    }

    fn apart(&self, _: &[Planted], _: &[Planted]) -> f64 {
        100.0
    }
}

/// Takes a delay and a scale for tied, whatever the log, and asks for one of this length.
struct Tied<'a>(&'a [Variant], Option<f64>);

impl Diagnoses for Tied<'_> {
    fn name(&self) -> &str {
        "asami"
    }

    fn diagnose(&self, _: &Log) -> Result<Diagnosis, CannotDiagnose> {
        let of = |name: &str| {
            let variant = self.0.iter().find(|it| it.about.name == name).expect("in the catalogue").clone();
            Diagnosis::flat(&[Planted { size: variant.sizes().1, variant }])
        };
        let [delay, scale] = ["command_delay", "command_scale"].map(of);
        let which: Vec<Cause> = [scale.which, delay.which].concat();
        Ok(Diagnosis {
            verdict: Verdict::Tied,
            which,
            next_keys: Some("explore.hold_s = 8".to_owned()),
            next_nats: Some([1.0, 8.0]),
            next_length_s: self.1,
            ..Diagnosis::flat(&[])
        })
    }
}

struct Advises {
    variants: Vec<Variant>,
    world: Simulation,
    length_s: Option<f64>,
    seen: Mutex<Vec<Log>>,
    learned: AtomicUsize,
}

impl Judges for Advises {
    fn of<'a>(&'a self, log: &'a Log) -> Result<Box<dyn Likelihood + 'a>, CannotDiagnose> {
        self.seen.lock().expect("free").push(log.clone());
        Ok(Box::new(ForDelay(1.0)))
    }
}

/// What is known of the world that is driven as advised.
struct OfAdvised<'a>(&'a Advises);

impl Judges for OfAdvised<'_> {
    fn of<'a>(&'a self, log: &'a Log) -> Result<Box<dyn Likelihood + 'a>, CannotDiagnose> {
        let longest_s = self.0.length_s.unwrap_or(ADVISED_S);
        assert!(
            log.span_s().is_some_and(|(from_s, to_s)| to_s - from_s > longest_s - 1.0),
            "driven as it is not advised"
        );
        self.0.seen.lock().expect("free").push(log.clone());
        Ok(Box::new(ForDelay(9.0)))
    }
}

impl Contest for Advises {
    fn judges(&self) -> &dyn Judges {
        self
    }

    fn variants(&self) -> &[Variant] {
        &self.variants
    }

    fn diagnosers(&self, _: &[String]) -> Vec<Box<dyn Diagnoses + '_>> {
        vec![Box::new(Tied(&self.variants, self.length_s))]
    }

    fn driven(&self, keys: &str) -> Result<Option<Driven<'_>>, CannotShelve> {
        assert_eq!(keys, "explore.hold_s = 8");
        self.learned.fetch_add(1, Ordering::Relaxed);
        let world = Simulation { duration_s: ADVISED_S, ..self.world.clone() };
        Ok(Some(Driven { world, judges: Box::new(OfAdvised(self)) }))
    }

    fn fingerprint(&self) -> String {
        "advises".to_owned()
    }
}

fn advises(text: &str, length_s: Option<f64>) -> Advises {
    let (variants, world) = (Variant::all("plain", 4, &[]), blind(text).world);
    Advises { variants, world, length_s, seen: Mutex::default(), learned: AtomicUsize::default() }
}

fn sweep(text: &str, contest: &Advises, out: &Path) -> Results {
    let results = run(&blind(text), contest, &options(out, 1), &Silent).expect("run");
    report::blind::write(&results, "test", out).expect("written");
    results
}

fn swept(text: &str, length_s: Option<f64>) -> (Results, Vec<Log>) {
    let (dir, contest) = (tempfile::tempdir().expect("made"), advises(text, length_s));
    (sweep(text, &contest, dir.path()), contest.seen.into_inner().expect("free"))
}

/// Forty cases of a diagnoser that asks for more.
fn asking() -> String {
    ASKED
        .replace("duration_s = 5\ncases = 12", "duration_s = 5\ncases = 40\nnext_experiment = true")
        .replace("[\"asami\", \"forward_selection\"]", "[\"asami\"]")
        + "[mix]\nnone_share = 0.1\none_share = 0.8\n"
}

#[test]
fn a_tie_is_followed_by_two_logs_of_the_true_world() {
    let text = asking();
    let (results, seen) = swept(&text, None);
    let mut followed = 0;
    for record in &results.records {
        let expected = match record.planted.iter().map(String::as_str).collect::<Vec<_>>()[..] {
            ["command_delay"] => Some(Next { advised_nats: 9.0, again_nats: 1.0, promised_nats: Some(8.0) }),
            // The log speaks for what is not the truth.
            ["command_scale"] => Some(Next { advised_nats: -9.0, again_nats: -1.0, promised_nats: Some(8.0) }),
            _ => None,
        };
        assert_eq!(record.answers[0].next, expected, "{:?}", record.planted);
        followed += usize::from(expected.is_some());
    }
    assert!(followed >= 3, "{followed}");
    assert_eq!(seen.len(), 40 + 2 * followed);
    let other = |a: &Log, b: &Log| a.sightings != b.sightings;
    assert!(seen.iter().enumerate().all(|(i, a)| seen[..i].iter().all(|b| other(a, b))), "no log is another one again");

    let all: Vec<_> = asked(&results, 0).collect();
    let delays = all.iter().filter(|it| it.record.planted == ["command_delay"]).count() as u32;
    let share = |what| measure(what, &all).share.expect("a share");
    assert_eq!(share(Measure::NextSplits).count, delays);
    assert_eq!(share(Measure::NextSplits).of as usize, followed);
    assert_eq!(share(Measure::AgainSplits).count, 0);
    assert_eq!(share(Measure::NextBeatsAgain).count, delays);

    let (unasked, seen) = swept(&text.replace("next_experiment = true", "next_experiment = false"), None);
    assert!(unasked.records.iter().all(|record| record.answers[0].next.is_none()));
    assert_eq!(seen.len(), 40);
}

#[test]
fn what_was_recorded_next_is_not_recorded_again() {
    let text = asking();
    let (dir, contest) = (tempfile::tempdir().expect("made"), advises(&text, None));
    let first = sweep(&text, &contest, dir.path());
    let count = || (contest.seen.lock().expect("free").len(), contest.learned.load(Ordering::Relaxed));
    let (seen, learned) = count();
    assert_eq!(learned, 1, "one way to drive is learned once for all cases");
    assert_eq!(sweep(&text, &contest, dir.path()), first);
    assert_eq!(count(), (seen, learned));
    let followed = first.records.iter().find(|it| it.answers[0].next.is_some()).expect("some").number;
    std::fs::remove_file(dir.path().join(format!("cases/{followed:05}.json"))).expect("there");
    let again = sweep(&text, &contest, dir.path());
    let answers = |of: &Results| of.records.iter().map(|record| record.answers.clone()).collect::<Vec<_>>();
    assert_eq!(answers(&again), answers(&first));
    assert_eq!(count(), (seen + 3, 2), "its own log and two more");
}

#[test]
fn both_logs_are_as_long_as_is_asked_for() {
    let text = ASKED
        .replace("duration_s = 5\ncases = 12", "duration_s = 5\ncases = 20\nnext_experiment = true")
        .replace("[\"asami\", \"forward_selection\"]", "[\"asami\"]");
    let (results, seen) = swept(&text, Some(12.0));
    let followed = results.records.iter().filter(|it| it.answers[0].next.is_some()).count();
    let long = seen.iter().filter(|log| log.span_s().is_some_and(|(from_s, to_s)| to_s - from_s > 11.0)).count();
    assert!(followed > 0 && long == 2 * followed && seen.len() == 20 + long, "{followed} {long} {}", seen.len());
}

/// A blind scenario may drive the nominal robot otherwise than its own scenario does; a slip there is shown.
#[test]
fn keys_of_the_nominal_world_can_be_others() {
    let with = |change: &str| {
        let text = ASKED.replacen("\n[[expect]]", &format!("\n{change}\n\n[[expect]]"), 1);
        parse("try", "try.toml", &text, &|_| Ok(PLAIN.to_owned())).map(|it| it.expect("blind"))
    };
    let own = blind(ASKED);
    let other = with("[change.explore]\nhold_s = 0.25").expect("sound");
    let Policy::Explore(before) = &own.world.drive else { panic!("a robot that explores") };
    let exploring = Exploring { hold_s: 0.25, ..before.clone() };
    assert_eq!(other.world, Simulation { drive: Policy::Explore(exploring), ..own.world.clone() });
    assert_ne!(other.hash(), own.hash());
    for (change, said) in [
        ("[change.explore]\nhold_s = 99", "hold_s must lie in 0.1..=60 s, not 99"),
        ("[change.explore]\nholds = 1", "unknown field `holds`"),
    ] {
        let shown = format!("{:?}", miette::Report::new(with(change).expect_err(change)));
        assert!(shown.contains(said) && shown.contains("plain_2d, changed"), "{change}:\n{shown}");
    }
}
