//! Diagnoses of drives through a town: what is planted in the car or in its scanner is found, by scans alone.

use std::sync::{Arc, LazyLock};

use asami_dataset::{Action, Command, Firings, Log, Seed};
use asami_gap::drive::{Base, Drives, Entry};
use asami_gap::library::play;
use asami_gap::view::CannotSee;
use asami_gap::weigh::evidence::{CLOSE, weigh};
use asami_gap::{Budget, Planted, Responds, Variant};

mod town;

use town::Town;

const RUN_S: f64 = 24.0;

fn variants() -> Vec<Variant> {
    let named = |variant: &Variant| ["base_tilt", "steering_offset"].contains(&variant.about.name);
    Variant::all("car", 0, &[]).into_iter().filter(named).collect()
}

fn library() -> &'static Drives {
    static LIBRARY: LazyLock<Drives> = LazyLock::new(|| {
        let (town, budget) = (Town::default(), Budget { nominal_runs: 4, runs: 1, sizes: 2, run_s: RUN_S });
        let base = Base::learn(&town, &budget).unwrap();
        let entry = |variant: &Variant| Entry::learn(&town, &base, variant, &budget).unwrap();
        let entries = variants().iter().map(entry).collect();
        Drives::new(base, entries)
    });
    &LIBRARY
}

fn log(planted: &[Planted]) -> Log {
    play(&Town::default(), planted, Seed(1000), RUN_S).unwrap().log
}

fn planted(name: &str, sign: f64, size: f64) -> Planted {
    let variant = variants().into_iter().find(|it| it.about.name == name && it.sign == sign).unwrap();
    Planted { variant, size }
}

#[test]
fn what_is_planted_is_the_most_evident_and_where_nothing_is_nothing_is_evident() {
    let nominal = log(&[]);
    let judge = library().judge(&nominal).unwrap();
    for weighed in weigh(&*judge, &variants(), &[], CLOSE) {
        // Evidence of e^9 for what is absent has probability e^-9 at most (Markov).
        assert!(weighed.evidence_nats < 9.0, "{weighed:?}");
    }
    for (name, sign, size) in [("base_tilt", -1.0, 0.01), ("steering_offset", 1.0, 0.004)] {
        let log = log(&[planted(name, sign, size)]);
        let judge = library().judge(&log).unwrap();
        let all = weigh(&*judge, &variants(), &[], CLOSE);
        let best = all.into_iter().reduce(|a, b| if b.evidence_nats > a.evidence_nats { b } else { a }).unwrap();
        assert_eq!((best.effect, best.best.variant.sign), (name, sign), "{best:?}");
        assert!(best.evidence_nats > 10.0 && (best.best.size / size).ln().abs() < 0.3, "{best:?}");
    }
}

#[test]
fn logs_that_show_nothing_are_refused() {
    let whole = log(&[]);
    let refused = |log: &Log| library().judge(log).err().unwrap().to_string();
    assert!(refused(&Log { firings: None, ..whole.clone() }).contains("no laser firings"));
    let one_turn = whole.window(0.0..0.15);
    assert!(!refused(&one_turn).is_empty());
    assert_eq!(library().judge(&Log { commands: Vec::new().into(), ..whole.clone() }).err(), Some(CannotSee::NoPedals));
    let standing = whole.window(0.0..1.4);
    assert!(refused(&standing).contains("which way is forward"), "{}", refused(&standing));
    // Ranges all alike hold no laser.
    let firings = whole.firings.as_deref().unwrap();
    let fog = Firings { range_2mm: vec![vec![0; firings.len()]; firings.lasers()], ..firings.clone() };
    assert!(!refused(&Log { firings: Some(Arc::new(fog)), ..whole.clone() }).is_empty());
    // The pedals never move, and still it is a log.
    let held = Command { t_s: 0.0, action: Action::Pedals { throttle: 0.05, brake: 0.0, steering: 0.0 } };
    let constant = Log { commands: vec![held].into(), ..whole };
    assert!(library().judge(&constant).is_ok());
}
