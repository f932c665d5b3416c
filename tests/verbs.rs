//! The verbs as a user meets them: what they print, write and exit with.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use asami_dataset::survey::{Height, Speed};
use asami_dataset::{
    Action, ActionModel, Beacon, Camera, Dataset, Known, Log, Models, SensorModel, Sighting, Size, Survey, TruePose,
    Truth, store,
};
use asami_math::polynomial::Polynomial;

/// Ten seconds of one robot before one beacon.
const SCENARIO: &str = r#"
schema = 1
about = "Does it walk?"
robot = "aibo"
duration_s = 10
seeds = 1

[[field.beacons]]
id = 0
body = { x_m = 0.0, y_m = 0.0, radius_m = 0.05, base_m = 0.1, height_m = 0.2, bands = ["pink", "yellow"] }

[[rows]]
learner = "canonical"
"#;

fn run(program: &str, arguments: &[&str]) -> Output {
    Command::new(program).args(arguments).output().unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// What was said on stderr, with the report's line breaks and bars taken out.
fn said(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    text.split_whitespace().filter(|word| !["│", "×"].contains(word)).collect::<Vec<_>>().join(" ")
}

#[track_caller]
fn refused(output: &Output, sentence: &str) {
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(said(output).contains(sentence), "\nwanted: {sentence}\nfound:  {}", said(output));
    assert_eq!(stdout(output), "", "errors are no results");
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// A robot that paces before a beacon; its heights are those of a thin lens, its speed bends.
fn walk() -> Dataset {
    let speed_of = |c: f64| 0.8 * c - 1.5 * c * c * c;
    let height_of = |d: f64| 38.0 / d;
    let (mut commands, mut sightings, mut track) = (Vec::new(), Vec::new(), Vec::new());
    let (mut y_m, mut ahead) = (-2.4, true);
    for n in 0..3000_u32 {
        let t_s = f64::from(n) * 0.05;
        if !(-3.5..=-1.3).contains(&y_m) {
            ahead = y_m < -2.4;
        }
        // A low-discrepancy sequence of speeds, each for 3 s.
        let size = 0.03 + 0.27 * (f64::from(n / 60) * 0.618_033_988_749_895).fract();
        let ay_m_per_s = if ahead { size } else { -size };
        let action = Action::Legs { id: None, ax_m_per_s: 0.0, ay_m_per_s, atheta_rad_per_s: 0.0 };
        commands.push(asami_dataset::Command { t_s, action });
        sightings.push(Sighting { t_s, landmark: 0, size: Size::HeightPx(height_of(-y_m)), bearing_rad: 0.0 });
        track.push(TruePose { t_s, x_m: 0.0, y_m, theta_rad: 0.0, v_m_per_s: None });
        y_m += 0.05 * speed_of(ay_m_per_s);
    }
    let known = Known {
        robot: "aibo".to_owned(),
        camera: Some(Camera { width_px: 208, height_px: 160, focal_px: 191.943, frame_rate_hz: 20.0 }),
        landmarks: vec![Beacon { id: 0, x_m: 0.0, y_m: 0.0, height_m: Some(0.2) }],
        ..Known::default()
    };
    let survey = Survey {
        speed_by_command: (-15..=15)
            .map(|i| f64::from(i) * 0.02)
            .map(|c| Speed { command_m_per_s: c, speed_m_per_s: speed_of(c), sd_m_per_s: 0.0, timings: 5 })
            .collect(),
        height_by_distance: (0..13)
            .map(|i| 1.2 + 0.2 * f64::from(i))
            .map(|d| Height { distance_m: d, height_px: height_of(d), sd_px: 0.0, bearing_sd_rad: 0.0, readings: 100 })
            .collect(),
        ..Survey::default()
    };
    let log = Log { known: known.into(), commands: commands.into(), sightings: sightings.into(), ..Log::default() };
    Dataset { log, truth: Truth { track: track.into(), survey: Some(survey) }, provenance: None }
}

#[test]
fn what_learn_writes_score_reads_and_finds_good() {
    let dir = tempfile::tempdir().unwrap();
    let (set, models) = (dir.path().join("walk"), dir.path().join("models.toml"));
    store::write(&walk(), &set).unwrap();
    for start in ["c", "sgn"] {
        let arguments =
            [text(&set), "--learner", "algorithm1", "--start", start, "--set", "gamma=0.9995", "-o", text(&models)];
        let learned = run(env!("CARGO_BIN_EXE_learn"), &arguments);
        assert_eq!(learned.status.code(), Some(0), "{}", said(&learned));
        assert_eq!(stdout(&learned).trim(), text(&models));
        assert_eq!(store::read_models(&models).unwrap().0, "algorithm1");

        let scored = run(env!("CARGO_BIN_EXE_score"), &[text(&models), text(&set)]);
        assert_eq!(scored.status.code(), Some(0), "{}", said(&scored));
        assert!(stdout(&scored).contains("algorithm1: converged"), "{}", stdout(&scored));
    }
}

/// Generate, learn, score: chapter 4 in the plane, as a user goes about it.
#[test]
fn a_field_is_generated_learned_from_and_scored() {
    let dir = tempfile::tempdir().unwrap();
    let (file, set, models) = (dir.path().join("short.toml"), dir.path().join("field"), dir.path().join("models.toml"));
    let scenario = include_str!("../scenarios/plain_2d.toml");
    let scenario =
        scenario.replace("duration_s = 900", "duration_s = 400").replace("sigma2_rad = 0.5", "sigma2_rad = 0.1");
    std::fs::write(&file, scenario).unwrap();
    let generated = run(env!("CARGO_BIN_EXE_generate"), &[text(&file), "--seed", "1000", "-o", text(&set)]);
    assert_eq!(generated.status.code(), Some(0), "{}", said(&generated));
    // The plain robot's truth is exact and costs nothing: it is always there.
    assert_eq!(store::read(&set).unwrap().truth.survey.unwrap().velocity_by_action.len(), 40);

    let learn = |start: &[&str]| {
        let arguments = [&[text(&set), "--learner", "em_rts", "-o", text(&models)], start].concat();
        run(env!("CARGO_BIN_EXE_learn"), &arguments)
    };
    refused(&learn(&[]), "em_rts needs action, sensor and noise models: --start published");
    refused(&learn(&["--start", "sgn"]), "em_rts cannot start from sgn");
    let learned = learn(&["--start", "attempted", "--set", "max_iterations=30"]);
    assert_eq!(learned.status.code(), Some(0), "{}", said(&learned));
    let scored = run(env!("CARGO_BIN_EXE_score"), &[text(&models), text(&set)]);
    let table = stdout(&scored);
    for part in ["v_theta", "rad/s", "sigma_1 (px): ", "true 1.0000", "normalised innovations", "em_rts: converged"] {
        assert!(table.contains(part), "{part:?} is not in\n{table}{}", said(&scored));
    }
}

#[test]
fn learners_are_not_told_the_truth() {
    let dir = tempfile::tempdir().unwrap();
    let mut sets = [walk(), walk()];
    sets[1].truth = Truth::default();
    let models = sets.map(|dataset| {
        let (set, models) = (dir.path().join("walk"), dir.path().join("models.toml"));
        store::write(&dataset, &set).unwrap();
        let learned = run(
            env!("CARGO_BIN_EXE_learn"),
            &[text(&set), "--learner", "canonical", "--from-s", "10", "--duration-s", "100", "-o", text(&models)],
        );
        assert!(learned.status.success(), "{}", said(&learned));
        std::fs::read(models).unwrap()
    });
    assert_eq!(models[0], models[1]);
}

#[test]
fn models_of_another_program_are_scored() {
    let dir = tempfile::tempdir().unwrap();
    let (set, path) = (dir.path().join("walk"), dir.path().join("models.toml"));
    store::write(&walk(), &set).unwrap();
    // Speeds exactly as surveyed, in half metres; a place that falls with the height is the wrong way round.
    std::fs::write(
        &path,
        "schema = 1\nlearner = \"mine\"\n[action]\nkind = \"polynomial\"\ncoefficients = [0.0, 1.6, 0.0, -3.0]\n\
         [sensor]\nkind = \"distance_of_height\"\ncoefficients = [0.0, -1.0]\n",
    )
    .unwrap();
    let scored = run(env!("CARGO_BIN_EXE_score"), &[text(&path), text(&set)]);
    let table = stdout(&scored);
    let action: Vec<&str> = table.lines().find(|line| line.starts_with("action")).unwrap().split_whitespace().collect();
    assert_eq!(action[..4], ["action", "0.0", "mm/s", "0.00"], "{table}");
    assert_eq!(action.last(), Some(&"0.50000"), "{table}");
    assert!(table.contains("mine: diverged: ") && table.contains("scales of opposite sign"), "{table}");
}

#[test]
fn what_cannot_be_learned_or_scored_is_said_in_a_sentence() {
    let dir = tempfile::tempdir().unwrap();
    let (set, models) = (dir.path().join("walk"), dir.path().join("models.toml"));
    let learn = |arguments: &[&str]| run(env!("CARGO_BIN_EXE_learn"), &[&[text(&set)], arguments].concat());
    refused(&learn(&["--learner", "canonical"]), "dataset.toml: the file must be there");

    let mut blind = walk();
    blind.log.sightings = Vec::new().into();
    blind.truth = Truth::default();
    store::write(&blind, &set).unwrap();
    refused(&learn(&["--learner", "canonical"]), "canonical cannot learn from this log: the log has no sightings");
    refused(&learn(&["--learner", "cannonical"]), "did you mean canonical?");
    refused(&learn(&["--learner", "algorithm1"]), "algorithm1 needs an action model: --start c");
    refused(
        &learn(&["--learner", "canonical", "--set", "sensor_degree=99"]),
        "sensor_degree must lie in 1..=8, not 99",
    );
    refused(&learn(&["--learner", "canonical", "--set", "degree=3"]), "there is no parameter degree");
    assert_eq!(learn(&["--learner", "algorithm1", "--start", "two"]).status.code(), Some(2));

    let identity = Models {
        action: Some(ActionModel::Polynomial(Polynomial::plain(vec![0.0, 1.0]).into())),
        sensor: Some(SensorModel::HeightOfDistance(Polynomial::plain(vec![0.0, 1.0]).into())),
        ..Models::default()
    };
    store::write_models("x", &identity, &models).unwrap();
    let score = || run(env!("CARGO_BIN_EXE_score"), &[text(&models), text(&set)]);
    refused(&score(), "the data set has no truth about the models");
    store::write(&walk(), &set).unwrap();
    let ranges = SensorModel::RangeOfDistance(Polynomial::plain(vec![0.0, 1.0]).into());
    store::write_models("x", &Models { sensor: Some(ranges), ..Models::default() }, &models).unwrap();
    refused(&score(), "nothing to score");

    let sightings = set.join("sightings.csv");
    let broken = std::fs::read_to_string(&sightings).unwrap().replacen("\n0.05,0,", "\n0.05,7,", 1);
    std::fs::write(&sightings, broken).unwrap();
    let refusal = score();
    refused(&refusal, "sightings.csv:3:6: landmark must be one that dataset.toml declares, not 7");
    assert!(said(&refusal).contains("0.05,7,"), "the line is shown: {}", said(&refusal));
}

#[test]
fn the_catalogue_shows_everything_with_its_parameters() {
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let all = stdout(&run(env!("CARGO_BIN_EXE_list"), &["--scenarios", text(&scenarios)]));
    let effects = asami_sim::effects::catalogue().into_iter().map(|about| (about.name, about.source, about.parameters));
    let learners = asami_learners::catalogue().into_iter().map(|about| (about.name, about.source, about.parameters));
    for (name, source, parameters) in effects.chain(learners) {
        assert!(all.lines().any(|line| line == name) && all.contains(source), "{name}");
        for parameter in parameters {
            assert!(all.contains(&format!("    {} ", parameter.name)), "{name}.{}", parameter.name);
        }
    }
    for importer in asami::import::catalogue() {
        assert!(all.lines().any(|line| line == importer.name));
    }
    for file in std::fs::read_dir(&scenarios).unwrap() {
        assert!(all.contains(text(&file.unwrap().path())));
    }
    assert!(!all.contains("cannot be used"), "{all}");
    let effects = stdout(&run(env!("CARGO_BIN_EXE_list"), &["effects"]));
    assert!(all.contains(&effects) && effects.len() < all.len());
}

/// Generates into a folder of this name; the files with their bytes.
fn generated(dir: &Path, name: &str, arguments: &[&str]) -> Vec<(String, Vec<u8>)> {
    let (scenario, out) = (dir.join("short.toml"), dir.join(name));
    std::fs::write(&scenario, SCENARIO).unwrap();
    let generated = run(env!("CARGO_BIN_EXE_generate"), &[&[text(&scenario), "-o", text(&out)], arguments].concat());
    assert!(generated.status.success(), "{}", said(&generated));
    let mut files: Vec<PathBuf> = std::fs::read_dir(&out).unwrap().map(|file| file.unwrap().path()).collect();
    files.sort();
    let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
    files.iter().map(|path| (name(path), std::fs::read(path).unwrap())).collect()
}

/// A simulated Create that is told what another was told is told the same, and does what its own world has it do; others cannot be.
#[test]
fn commands_of_a_log_are_given_to_another_robot() {
    let dir = tempfile::tempdir().unwrap();
    let create = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/create.toml");
    let path = |name: &str| dir.path().join(name);
    let generate = |out: &Path, more: &[&str]| {
        run(env!("CARGO_BIN_EXE_generate"), &[&[text(&create), "-o", text(out)], more].concat())
    };
    let first = generate(&path("first"), &["--seed", "7", "--duration-s", "20"]);
    assert!(first.status.success(), "{}", said(&first));
    let told = path("first");
    for (name, more) in [("same", &[][..]), ("slow", &["--effect", "command_scale.y_ratio=0.8"])] {
        let again = generate(&path(name), &[&["--seed", "7", "--commands-of", text(&told)], more].concat());
        assert!(again.status.success(), "{}", said(&again));
    }
    let [first, same, slow] = ["first", "same", "slow"].map(|name| store::read(&path(name)).unwrap());
    assert_eq!(slow.log.commands, first.log.commands);
    let last = same.truth.track.len().min(first.truth.track.len());
    assert_eq!(same.truth.track[..last], first.truth.track[..last]);
    assert_ne!(slow.truth.track[..last], first.truth.track[..last]);
    assert!(same.provenance.is_none(), "no scenario makes it again");
    let walker = generated_refused(dir.path(), &["--commands-of", text(&told)]);
    refused(&walker, "commands of another log are for robots on wheels");
    refused(
        &generate(&path("none"), &["--commands-of", text(&path("nowhere"))]),
        "dataset.toml: the file must be there",
    );
}

/// What `generate` says of the short scenario of an Aibo.
fn generated_refused(dir: &Path, arguments: &[&str]) -> Output {
    let (scenario, out) = (dir.join("short.toml"), dir.join("refused"));
    std::fs::write(&scenario, SCENARIO).unwrap();
    run(env!("CARGO_BIN_EXE_generate"), &[&[text(&scenario), "-o", text(&out)], arguments].concat())
}

#[test]
fn a_scenario_gives_the_same_data_set_again_and_effects_leave_no_name_in_it() {
    let dir = tempfile::tempdir().unwrap();
    let first = generated(dir.path(), "first", &["--seed", "7"]);
    let dataset = store::read(&dir.path().join("first")).unwrap();
    assert_eq!(dataset.log.known.nominal.as_deref(), Some("short"));
    assert_eq!(dataset.provenance.as_ref().map(|from| from.seed), Some(7));
    assert!(dataset.log.sightings.len() > 100 && !dataset.truth.track.is_empty());

    assert_eq!(generated(dir.path(), "again", &["--seed", "7"]), first);
    assert_eq!(generated(dir.path(), "null", &["--seed", "7", "--effect", "ground_friction.ratio=1"]), first);
    assert_ne!(generated(dir.path(), "other", &["--seed", "8"]), first);
    let slippery = generated(dir.path(), "slippery", &["--seed", "7", "--effect", "ground_friction.ratio=0.2"]);
    assert_ne!(slippery, first);
    for (name, bytes) in slippery {
        assert!(!String::from_utf8_lossy(&bytes).contains("friction"), "{name}");
    }
}

#[test]
fn a_bad_scenario_or_effect_is_shown() {
    let dir = tempfile::tempdir().unwrap();
    let scenario = dir.path().join("short.toml");
    let generate = |arguments: &[&str]| run(env!("CARGO_BIN_EXE_generate"), &[&[text(&scenario)], arguments].concat());
    refused(&generate(&[]), "cannot read");
    std::fs::write(&scenario, SCENARIO.replace("duration_s", "duration")).unwrap();
    refused(&generate(&[]), "did you mean `duration_s`?");
    std::fs::write(&scenario, SCENARIO).unwrap();
    let effect = |setting| generate(&["--effect", setting]);
    refused(&effect("ground_fricton.ratio=1"), "did you mean ground_friction?");
    refused(&effect("ground_friction.slip=1"), "effect ground_friction has no parameter slip; it has ratio");
    refused(&effect("ground_friction.ratio=9"), "ratio must lie in 0.1..=1.5, not 9");
    refused(&effect("ground_friction.ratio=nan"), "not NaN");
    refused(&effect("weak_leg.leg=1.5"), "effects.weak_leg.leg: leg must be a whole number, not 1.5");
    refused(&effect("weak_leg.leg=-1"), "leg must lie in 0..=3, not -1");
    refused(&effect("ground_friction"), "must be NAME.PARAM=VALUE");
}

/// Of real logs a sweep takes those that are named, and says what it cannot find.
#[test]
fn a_sweep_of_real_logs_says_what_it_lacks() {
    let dir = tempfile::tempdir().unwrap();
    let scenario = dir.path().join("mine.toml");
    let log = |name: &str| {
        format!(
            "[[logs]]\nname = \"{name}\"\nsource = \"no/such\"\nformat = \"barfoot-2d\"\nnominal = \"create_laser\"\n"
        )
    };
    let head = "schema = 1\nstudy = \"real\"\nabout = \"What parts them?\"\n";
    std::fs::write(&scenario, format!("{head}{}{}", log("one"), log("two"))).unwrap();
    let said = |arguments: &[&str]| {
        let done = run(env!("CARGO_BIN_EXE_sweep"), &[&[text(&scenario)], arguments].concat());
        assert_eq!(done.status.code(), Some(2));
        String::from_utf8_lossy(&done.stderr).into_owned()
    };
    assert!(said(&["--only", "three"]).contains("has no log called three"));
    assert!(said(&["--data", "elsewhere"]).contains("say which with --only NAME"));
    assert!(said(&["--seeds", "3"]).contains("--seeds is for simulated scenarios"));
    let absent = said(&["--only", "one"]);
    assert!(absent.contains("no/such") && absent.contains("--data DIR"), "{absent}");
}

/// Another program's cases that nobody wrote: said at once, with where to read how, before a library is played.
#[test]
fn cases_that_nobody_wrote_are_missed_at_once() {
    let dir = tempfile::tempdir().unwrap();
    let nowhere = dir.path().join("nowhere");
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/blind_foreign.toml");
    let arguments = [shipped.to_str().unwrap(), "--data", nowhere.to_str().unwrap()];
    let output = Command::new(env!("CARGO_BIN_EXE_sweep")).args(arguments).current_dir(dir.path()).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let said = said(&output);
    assert!(said.contains("holds no cases") && said.contains("docs/blind.md"), "{said}");
    assert!(!dir.path().join("results").exists(), "nothing was played");
}
