//! Blind sweeps: diagnosers see logs alone, results are the same whatever happened on the way, and counts are right.

mod folder;
mod next;
mod scores;
mod size;
mod two;

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use asami::blind::answer::{Answer, Key};
use asami::blind::next::Driven;
use asami::blind::referee::{Effect, Reference};
use asami::blind::scenario::{Blind, Measure, parse, read};
use asami::blind::tally::{Asked, Share, asked, confusion, measure, power, reliability};
use asami::blind::walk::{Contest, Record, Results, run};
use asami::blind::{rows, tables};
use asami::diagnose::shelf::CannotShelve;
use asami::report;
use asami::sweep::{Options, Silent, Timing};
use asami_dataset::Log;
use asami_gap::{CannotDiagnose, Diagnoses, Diagnosis, Judges, Likelihood, Planted, Variant};

const PLAIN: &str = include_str!("../../scenarios/plain_2d.toml");

const ASKED: &str = r#"
schema = 1
study = "blind"
about = "Is it found?"
nominal = "plain_2d"
duration_s = 5
cases = 12
salt = "1000"
diagnosers = ["asami", "forward_selection"]

[[expect]]
diagnoser = "asami"
measure = "none_called_else"
max = 1.0
"#;

fn blind(text: &str) -> Blind {
    parse("try", "try.toml", text, &|_| Ok(PLAIN.to_owned())).expect("sound").expect("blind")
}

/// A likelihood of a log that hangs on all of it and on what is planted.
struct OfBytes {
    base: f64,
}

impl Likelihood for OfBytes {
    fn blocks(&self, effects: &[Planted]) -> Vec<f64> {
        effects.iter().fold(vec![self.base], |mut blocks, planted| {
            blocks.push((planted.size * 1e3).sin() * 5.0);
            blocks
        })
    }

    fn observations(&self) -> usize {
        100
    }

    fn apart(&self, _: &[Planted], _: &[Planted]) -> f64 {
        100.0
    }
}

/// Names an effect by nothing but the log.
struct Guess<'a> {
    name: &'static str,
    variants: &'a [Variant],
    calls: &'a AtomicUsize,
}

impl Diagnoses for Guess<'_> {
    fn name(&self) -> &str {
        self.name
    }

    fn diagnose(&self, log: &Log) -> Result<Diagnosis, CannotDiagnose> {
        self.calls.fetch_add(1, Ordering::Relaxed);
        assert_eq!(log.known.nominal.as_deref(), Some("plain_2d"));
        let Some(variant) = self.variants.get(log.sightings.len() % (2 * self.variants.len())) else {
            return if log.sightings.len().is_multiple_of(5) {
                Err(CannotDiagnose("nothing, nothing at all".to_owned()))
            } else {
                Ok(Diagnosis::flat(&[]))
            };
        };
        Ok(Diagnosis::flat(&[Planted { variant: variant.clone(), size: variant.sizes().1 }]))
    }
}

#[derive(Default)]
struct StandIns {
    variants: Vec<Variant>,
    calls: AtomicUsize,
}

impl Judges for StandIns {
    fn of<'a>(&'a self, log: &'a Log) -> Result<Box<dyn Likelihood + 'a>, CannotDiagnose> {
        Ok(Box::new(OfBytes { base: -(log.sightings.len() as f64) }))
    }
}

impl Contest for StandIns {
    fn judges(&self) -> &dyn Judges {
        self
    }

    fn variants(&self) -> &[Variant] {
        &self.variants
    }

    fn diagnosers(&self, _: &[String]) -> Vec<Box<dyn Diagnoses + '_>> {
        let of = |name| Box::new(Guess { name, variants: &self.variants, calls: &self.calls }) as Box<dyn Diagnoses>;
        vec![of("asami"), of("forward_selection")]
    }

    fn driven(&self, _: &str) -> Result<Option<Driven<'_>>, CannotShelve> {
        Ok(None)
    }

    fn fingerprint(&self) -> String {
        "stand-ins".to_owned()
    }
}

fn stand_ins() -> StandIns {
    StandIns { variants: Variant::all("plain", 4, &[]), ..StandIns::default() }
}

fn options(out: &Path, jobs: usize) -> Options {
    Options { out: out.to_owned(), jobs: Some(jobs), program: "test".to_owned() }
}

/// Everything that a sweep writes, but times and cases.
fn written(out: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = std::fs::read_dir(out).expect("a folder").flatten().map(|entry| entry.path());
    let mut files: Vec<_> = entries
        .filter(|path| path.is_file() && !path.ends_with("timings.csv"))
        .map(|path| (path.file_name().unwrap().display().to_string(), std::fs::read(&path).unwrap()))
        .collect();
    files.sort();
    files
}

#[test]
fn a_sweep_is_the_same_on_any_threads_and_goes_on_where_it_stopped() {
    let blind = blind(ASKED);
    let dir = tempfile::tempdir().expect("made");
    let (one, many) = (dir.path().join("one"), dir.path().join("many"));
    let contest = stand_ins();
    let sweep = |out: &Path, jobs: usize| {
        std::fs::create_dir_all(out).expect("made");
        let results = run(&blind, &contest, &options(out, jobs), &Silent).expect("run");
        report::blind::write(&results, "test", out).expect("written");
        results
    };
    let first = sweep(&one, 1);
    assert_eq!(contest.calls.swap(0, Ordering::Relaxed), 24);
    sweep(&many, 4);
    assert_eq!(contest.calls.swap(0, Ordering::Relaxed), 24);
    assert_eq!(written(&one), written(&many));

    // Three cases lost, one of them half written.
    let case = |number: usize| many.join("cases").join(format!("{number:05}.json"));
    std::fs::remove_file(case(3)).expect("removed");
    std::fs::rename(case(5), case(5).with_extension("json.part")).expect("renamed");
    std::fs::write(case(7), "{\"key\": \"of another program\"}").expect("written");
    let again = sweep(&many, 2);
    assert_eq!(contest.calls.swap(0, Ordering::Relaxed), 6);
    assert_eq!(written(&one), written(&many));
    assert_eq!(rows::trials(&first), rows::trials(&again));
    assert!(!case(5).with_extension("json.part").exists());

    let trials = String::from_utf8(std::fs::read(one.join("trials.csv")).expect("there")).expect("text");
    assert!(trials.starts_with(
        "scenario,diagnoser,case,effects_true,d_det,d_sep,verdict,effects_named,probability,top_group_right,in_set90,\
         set_size,place_right,parameter_error,excess_before,excess_after,closed,oracle_closed,effect_withheld,"
    ));
    assert_eq!(trials.lines().count(), 1 + 24);
    let columns = rows::COLUMNS.split(',').count();
    assert!(trials.lines().all(|line| line.split(',').count() >= columns));
    assert!(
        trials.contains("\"nothing, nothing at all\"") || first.records.iter().all(|it| it.answers[0].error.is_empty())
    );
}

/// More cases of the same salt are the same cases and more.
#[test]
fn a_sweep_of_more_cases_keeps_those_that_are_done() {
    let dir = tempfile::tempdir().expect("made");
    let contest = stand_ins();
    let few = run(&blind(&ASKED.replace("cases = 12", "cases = 4")), &contest, &options(dir.path(), 2), &Silent);
    let more = run(&blind(&ASKED.replace("cases = 12", "cases = 6")), &contest, &options(dir.path(), 2), &Silent);
    assert_eq!(contest.calls.load(Ordering::Relaxed), 12);
    assert_eq!(few.expect("run").records[..], more.expect("run").records[..4]);
}

fn effect(name: &str, group: &[&str]) -> Effect {
    Effect {
        name: name.to_owned(),
        place: "actuation".to_owned(),
        block: "timing".to_owned(),
        parameter: "delay_s".to_owned(),
        value: 0.1,
        size: 0.1,
        sizes: (0.01, 1.0),
        group: group.iter().map(|name| (*name).to_owned()).collect(),
    }
}

fn record(planted: &[&str], named: &str, probability: f64, right: bool, d_sep: f64) -> Record {
    let effects = planted.iter().map(|name| effect(name, &[name])).collect();
    let answer = Answer {
        verdict: "named".to_owned(),
        named: named.split('+').map(str::to_owned).collect(),
        probability,
        top_group_right: right,
        named_right: right,
        in_set90: right,
        set_size: 2,
        ..Answer::default()
    };
    Record {
        number: 1,
        reference: Some(Reference {
            effects,
            none: -10.0,
            truth: Some(10.0),
            d_det: None,
            d_sep: Some(d_sep),
            d_each: Some(d_sep),
            least_error: None,
            observations: 10,
        }),
        planted: planted.iter().map(|name| (*name).to_owned()).collect(),
        withheld: Vec::new(),
        answers: vec![answer],
        error: String::new(),
        timing: Timing::default(),
    }
}

fn results(records: Vec<Record>) -> Results {
    Results::new(&blind(ASKED), records)
}

#[test]
fn counts_are_those_of_the_cases() {
    let mut records = vec![
        record(&["a"], "a", 0.95, true, 12.0),
        record(&["a"], "a", 0.95, true, 40.0),
        record(&["a"], "b", 0.95, false, 4.0),
        record(&["b"], "none", 0.55, false, 1.0),
        record(&[], "none", 0.85, true, 2.0),
        record(&[], "a", 0.45, false, 2.0),
        record(&["a", "b"], "a+b", 0.95, true, 20.0),
    ];
    records.push(Record { withheld: vec!["a".to_owned()], ..record(&["a"], "unknown", 0.85, true, 15.0) });
    records.push(Record { reference: None, ..record(&["a"], "b", 1.0, false, 0.0) });
    let results = results(records);
    let counts = confusion(asked(&results, 0));
    let of = |truth: &str, named: &str| counts.get(&(truth.to_owned(), named.to_owned())).copied().unwrap_or(0);
    let expected =
        [("a", "a", 2), ("a", "b", 1), ("b", "none", 1), ("none", "none", 1), ("none", "a", 1), ("two", "two", 1)];
    for (truth, named, count) in expected {
        assert_eq!(of(truth, named), count, "{truth} called {named}");
    }
    assert_eq!(of("unknown", "unknown"), 1);
    assert_eq!(counts.values().sum::<u32>(), 8, "the case without a reference is no case");

    let all: Vec<Asked<'_>> = asked(&results, 0).collect();
    let share = |what| measure(what, &all).share.expect("a share");
    assert_eq!(share(Measure::NoneCalledElse), Share { count: 1, of: 2 });
    assert_eq!(share(Measure::TopGroupRight), Share { count: 4, of: 6 });
    assert_eq!(share(Measure::ConfidentWrong), Share { count: 1, of: 4 });
    assert_eq!(share(Measure::ConfidentlyMisnamed), Share { count: 1, of: 8 });
    assert_eq!(share(Measure::Unknown), Share { count: 1, of: 8 });
    assert_eq!(measure(Measure::SetSize, &all).value, Some(2.0));
    // 0.95 thrice right of four, 0.85 twice of two, 0.55 and 0.45 never.
    let off = 4.0 * (0.95_f64 - 0.75) + 2.0 * (1.0 - 0.85) + 0.55 + 0.45;
    let found = measure(Measure::CalibrationError, &all).value.expect("a number");
    assert!((found - off / 8.0).abs() < 1e-12, "{found}");
    assert_eq!(reliability(all.iter().copied()).len(), 4);
    // Size 0.1 in 0.01..1 is the middle of five bins.
    let power = power(asked(&results, 0), "a");
    assert_eq!(power.len(), 1);
    assert!((power[0].size - 0.1).abs() < 1e-12 && power[0].right == Share { count: 3, of: 4 });
    // Wilson (1927) for 4 of 6, as Newcombe (1998) computes it.
    let [low, high] = Share { count: 4, of: 6 }.interval().expect("an interval");
    assert!((low - 0.2999).abs() < 1e-3 && (high - 0.9032).abs() < 1e-3, "{low} {high}");
    let strata = &tables::all(&results)[0].1;
    let column = |name: &str| strata.heads.iter().position(|head| head == name).expect("a column");
    let cases: Vec<_> = strata.rows.iter().map(|row| row.cells[column("cases")].value).collect();
    assert_eq!(cases[..5], [1.0, 1.0, 3.0, 1.0, 6.0].map(Some), "{strata:?}");
}

/// A group's other member is right, a third effect too many is not, and taken out of the list the truth is *unknown*.
#[test]
fn answers_are_held_against_the_groups_of_the_truth() {
    let variants = Variant::all("plain", 4, &[]);
    let of = |name: &str| {
        let variant = variants.iter().find(|it| it.about.name == name).expect("in the catalogue").clone();
        Planted { size: variant.sizes().1, variant }
    };
    let likelihood = OfBytes { base: 0.0 };
    let score = |effects: Vec<Effect>, withheld: &[&str], named: &[Planted]| {
        let reference = Reference {
            effects,
            none: -50.0,
            truth: Some(0.0),
            d_det: None,
            d_sep: Some(20.0),
            d_each: None,
            least_error: Some(0.1),
            observations: 10,
        };
        let withheld: Vec<String> = withheld.iter().map(|name| (*name).to_owned()).collect();
        let withheld = &withheld[..];
        let key = Key { reference: &reference, withheld, likelihood: &likelihood, variants: &variants };
        key.score(&Diagnosis::flat(named))
    };
    let delay = || effect("command_delay", &["command_delay", "image_delay"]);
    let scale = || effect("command_scale", &["command_scale"]);
    let right = |effects, named: &[&str]| {
        let named: Vec<Planted> = named.iter().map(|name| of(name)).collect();
        let answer = score(effects, &[], &named);
        assert_eq!((answer.top_group_right, answer.in_set90), (answer.named_right, answer.named_right));
        answer.named_right
    };
    assert!(right(vec![delay()], &["command_delay"]));
    assert!(right(vec![delay()], &["image_delay"]));
    assert!(!right(vec![delay()], &["command_scale"]));
    assert!(!right(vec![delay()], &["command_delay", "command_scale"]));
    assert!(!right(vec![delay()], &[]));
    assert!(right(vec![], &[]));
    assert!(!right(vec![], &["command_delay"]));
    assert!(right(vec![delay(), scale()], &["command_scale", "image_delay"]));
    assert!(!right(vec![delay(), scale()], &["command_delay", "image_delay"]));
    assert!(!right(vec![delay(), scale()], &["command_delay"]));
    assert!(!score(vec![delay()], &["command_delay"], &[of("command_delay")]).named_right);
    // Of two causes one in the list: it may be named, alone, and what acts like it; nothing else may.
    let left = |named: &[&str]| {
        let named: Vec<Planted> = named.iter().map(|name| of(name)).collect();
        score(vec![delay(), scale()], &["command_scale"], &named).named_right
    };
    assert!(left(&["command_delay"]) && left(&["image_delay"]));
    assert!(!left(&["focal_error"]) && !left(&["command_delay", "focal_error"]) && !left(&[]));

    // Named at 0.2 s where 0.1 s is true and 50 nats are to be had: off by 100 %, the limit is 0.67 / 10.
    let answer = score(vec![delay()], &[], &[of("command_delay")]);
    let off = (of("command_delay").size - 0.1) / 0.1;
    assert!((answer.parameter_error.expect("an error") - off / 0.067).abs() < 1e-9);
    assert!((answer.parameter_error_cr.expect("an error") - off / 0.1).abs() < 1e-9);
    assert_eq!((answer.place_right, answer.parameter_covered), (Some(true), Some(false)));
    assert_eq!(answer.oracle_closed, Some(1.0));
}

#[test]
fn scenarios_are_checked_and_the_shipped_ones_are_sound() {
    for (from, to, said) in [
        ("cases = 12", "cases = 0", "cases must lie in 1..=100000, not 0"),
        ("\"forward_selection\"", "\"backward_selection\"", "unknown diagnoser `backward_selection`"),
        ("duration_s = 5", "duration_s = 0", "duration_s must lie in 1..=3600 s, not 0"),
        ("max = 1.0", "", "must have min, max or both"),
        ("salt = \"1000\"", "salt = \"1000\"\ngroups = [[\"slop\"]]", "there is no effect slop"),
        ("salt = \"1000\"", "", "salt must be some text, or cases_from a folder"),
        ("salt = \"1000\"", "salt = \"1000\"\ncases_from = \"x\"", "exclude each other"),
        ("salt = \"1000\"", "cases_from = \"x\"\nwithout_truth = true", "opened after all of them"),
        ("salt = \"1000\"", "cases_from = \"x\"\nwithout_one_of_two = true", "without_one_of_two needs keys before"),
        ("salt = \"1000\"", "cases_from = \"x\"\nnext_experiment = true", "next_experiment needs keys before"),
        ("salt = \"1000\"", "salt = \"1000\"\nwithout_truth_share = 1.5", "must lie in 0..=1, not 1.5"),
        ("salt = \"1000\"", "cases_from = \"x\"\nwithout_truth_share = 0.2", "without_truth_share needs keys before"),
        ("measure = \"none_called_else\"", "measure = \"nothing\"", "unknown variant"),
        ("schema = 1", "schema = 2", "schema must be 1 for this program, not 2"),
    ] {
        assert!(ASKED.contains(from), "{from}");
        let text = ASKED.replacen(from, to, 1);
        let bad = parse("try", "try.toml", &text, &|_| Ok(PLAIN.to_owned())).expect_err(to);
        let shown = format!("{:?}", miette::Report::new(bad));
        assert!(shown.contains(said), "{to}: {said:?} is not said in\n{shown}");
    }
    let of_another_kind = parse("x", "x.toml", PLAIN, &|_| Err("not asked for".to_owned()));
    assert_eq!(of_another_kind.expect("no fault"), None);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let mut found = 0;
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        if let Some(blind) = read(&entry.path()).expect("sound") {
            found += 1;
            assert!(!blind.asked.expect.is_empty(), "{} expects nothing", blind.name);
            assert!(asami::scenario::read(&entry.path()).is_err());
        }
    }
    assert!(found >= 3, "only {found}");
}
