//! A report as a reader gets it: one file, nothing outside it, scripts that run.

use std::io::Write as _;
use std::path::Path;
use std::process::Command;

use asami::draw::walk::{Part, Pose, Strip, contacts};
use asami::draw::{Figure, Mark, Picture, Stroke};
use asami::report::{Cell, Plate, Report, RowKind, Section, Table};

fn report() -> Report {
    let wave = |i: usize| [i as f64 * 0.1, (i as f64 * 0.1).sin() * 40.0];
    let lines = Figure::new("Figure 1", "A wave and its samples")
        .x("time", "s")
        .y("height", "px")
        .points("samples", Mark::Plus, (0..60).map(wave).collect::<Vec<_>>())
        .line("wave", Stroke::Solid, (0..60).map(wave).collect::<Vec<_>>())
        .level("greatest", 40.0)
        .caption("Samples lie on the wave.");
    let measured = |i: u32| {
        let error_mm = 60.0 + f64::from(i * 7 % 11);
        [f64::from(i), error_mm, error_mm - 12.0, error_mm + 12.0]
    };
    let bars = Figure::new("Figure 2", "Errors over seeds")
        .x("seed", "")
        .y("error", "mm")
        .y_from_zero()
        .error_bars("measured", (0..15).map(measured).collect::<Vec<_>>())
        .band("expected", [[0.0, 50.0, 80.0], [14.0, 50.0, 80.0]])
        .caption("Bars that miss the band ask for a look at their seed.");
    let leg = |bend: f64, far| Part { corners_m: vec![[0.0, 0.14], [bend, 0.07], [0.0, 0.0]], solid: false, far };
    let body =
        Part { corners_m: vec![[-0.05, 0.12], [0.15, 0.12], [0.15, 0.18], [-0.05, 0.18]], solid: true, far: false };
    let pose = |i: i32| Pose {
        t_s: f64::from(i) * 0.1,
        parts: vec![leg(0.02 * f64::from(i % 3), true), body.clone(), leg(-0.01 * f64::from(i), false)],
        contacts_m: vec![[0.0, 0.0]],
    };
    let strip = Strip {
        name: "Figure 3".into(),
        title: "A walk".into(),
        caption: "It walks.".into(),
        poses: (0..6).map(pose).collect(),
    };
    let steps: Vec<(f64, [bool; 4])> = (0..40)
        .map(|i| (f64::from(i) * 0.05, [i / 5 % 2 == 0, i / 5 % 2 == 1, i / 5 % 2 == 1, i / 5 % 2 == 0]))
        .collect();
    let feet = contacts("Figure 4", "Which foot stands when", &steps);
    let rgb: Vec<u8> = (0..208 * 160).flat_map(|i| [(i % 208) as u8, (i / 208) as u8, 128]).collect();
    let picture = Picture::new("Figure 5", "What the camera sees", 208, 160, rgb).caption("A gradient.");
    let table = Table::new("Table 1", &["learner", "error (mm)", "trials"])
        .caption("Click on a head to sort.")
        .row(RowKind::Ours, ["b".into(), Cell::mean_sd(9.0, 1.0, 1), Cell::number(15.0, 0)])
        .row(RowKind::Ours, ["a".into(), Cell::mean_sd(70.0, 13.0, 1).hint("median 68.1"), Cell::number(15.0, 0)])
        .row(RowKind::Published, ["dissertation".into(), Cell::mean_sd(70.4, 13.9, 1), Cell::default()]);
    Report::new("A demonstration", "Does a report hold together?")
        .answer("It does.")
        .section(
            Section::new("Lines").text("Two figures of `demo`.").figures([Plate::from(&lines), Plate::from(&bars)]),
        )
        .section(Section::new("The walk").figure(&strip).figure(&feet))
        .section(Section::new("Pixels").figure(&picture))
        .section(Section::new("Numbers").table(table))
        .footnote("A footnote.")
        .made_with("scenario", "blake3:0123")
}

/// What would make a browser ask for something outside the file.
const REFERENCES: [&str; 6] = ["http", "src=", "@import", "url(", "<link", "//cdn"];

fn assert_stands_alone(page: &str) {
    for reference in REFERENCES {
        assert!(!page.contains(reference), "the report contains {reference:?}");
    }
    let targets: Vec<&str> = page.split("href=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    assert!(targets.len() > 1);
    assert!(targets.iter().all(|target| target.starts_with('#') || target.starts_with("data:")), "{targets:?}");
}

#[test]
fn a_report_refers_to_nothing_outside_itself() {
    assert_stands_alone(&report().html());
}

#[test]
fn a_sweep_leaves_a_report_that_stands_alone_and_its_figures_as_files() {
    let dir = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("scenarios/aibo_1d.toml")).unwrap();
    let short = text.replace("duration_s = 300", "duration_s = 120").replace("duration_s = 150", "duration_s = 60");
    // A survey of a few paces: the whole one takes as long as the sweep.
    let survey = "\n[survey]\ntimings = 1\nspeed_step_m_per_s = 0.15\nslow_time_s = 1.0\ncourse_m = 0.3\nrun_up_s = 0.5\n\
                  distance_step_m = 1.2\nreadings = 2\n\n[divergence]";
    let short = short.replacen("\n[divergence]", survey, 1);
    let scenario = dir.path().join("aibo_1d.toml");
    std::fs::write(&scenario, short).unwrap();
    let out = dir.path().join("out");
    let status = Command::new(env!("CARGO_BIN_EXE_sweep"))
        .arg(&scenario)
        .args(["--seeds", "1", "-o"])
        .arg(&out)
        .output()
        .unwrap();
    assert!(status.status.success(), "{}", String::from_utf8_lossy(&status.stderr));

    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert_stands_alone(&page);
    let numbers = ["3.5a", "3.5b", "3.6", "3.7", "3.8a", "3.8b", "3.9, sensor", "3.9, action"];
    let figures = numbers.map(|number| format!("Figure {number}")).into_iter().chain(["Speed".to_owned()]);
    for name in figures {
        assert!(page.contains(&format!("<figcaption><b>{name}.</b>")), "{name} is missing");
        let file = name.to_lowercase().replace(", ", "_").replace([' ', '.'], "_");
        let svg = std::fs::read_to_string(out.join(format!("figures/{file}.svg"))).unwrap();
        assert!(svg.starts_with("<svg xmlns=") && !svg.contains("no data"), "{file}");
    }
    for name in ["The walk, side view", "Feet on the ground", "Camera at 1.3 m", "data:image/png;base64,"] {
        assert!(page.contains(name), "{name} is missing");
    }
    if let Some(browser) = chromium() {
        let dom = dom(browser, &out.join("report.html"), &dir.path().join("profile"));
        assert!(dom.contains("data-ready="), "scripts did not run");
    }
}

#[test]
fn a_report_is_written_whole_over_an_older_one() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("report.html");
    std::fs::write(&path, "old").unwrap();
    report().write(&path).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), report().html());
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
    let nowhere = dir.path().join("missing/report.html");
    assert!(report().write(&nowhere).unwrap_err().to_string().contains("missing/report.html"));
}

fn chromium() -> Option<&'static str> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    names.into_iter().find(|name| Command::new(name).arg("--version").output().is_ok_and(|out| out.status.success()))
}

/// The page after its scripts have run.
fn dom(browser: &str, page: &Path, profile: &Path) -> String {
    let out = Command::new(browser)
        .args(["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--no-first-run"])
        .arg(format!("--user-data-dir={}", profile.display()))
        .arg("--dump-dom")
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    String::from_utf8_lossy(&out.stdout).into_owned()
}

#[test]
fn scripts_run_in_a_browser() {
    let Some(browser) = chromium() else {
        // Past the capture of the test harness, which swallows what eprintln! says.
        let said = std::io::stderr().write_all(b"SKIPPED scripts_run_in_a_browser: no chromium on the path\n");
        return said.unwrap();
    };
    let dir = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    let page = dir.path().join("report.html");
    // Click on the second head twice and point at a sample, as a reader would, and leave what comes of it
    // where the dump shows it.
    let act = "<script>const head = document.querySelectorAll('th')[1]; head.click(); head.click();\
               const svg = document.querySelector('figure svg'), box = svg.getBoundingClientRect();\
               const { plot, x, y, series } = JSON.parse(document.querySelector('figure script').textContent);\
               const [u, v] = series[0].points[30], scale = box.width / svg.viewBox.baseVal.width;\
               const mx = plot[0] + (u - x.range[0]) / (x.range[1] - x.range[0]) * plot[2];\
               const my = plot[1] + (y.range[1] - v) / (y.range[1] - y.range[0]) * plot[3];\
               svg.dispatchEvent(new MouseEvent('mousemove', { clientX: box.left + mx * scale, clientY: box.top + my * scale }));\
               document.body.dataset.told = document.getElementById('tip').textContent.replaceAll('\\n', '; ');\
               document.body.dataset.order = [...document.querySelectorAll('tbody tr')].map(r => r.cells[0].textContent).join();</script>";
    std::fs::write(&page, report().html().replace("</body>", &format!("{act}</body>"))).unwrap();
    let dom = dom(browser, &page, &dir.path().join("profile"));
    assert!(dom.contains("data-ready=\"1 tables, 3 series\""), "scripts did not run: {dom:.400}");
    assert!(dom.contains("data-told=\"samples; time (s): 3; height (px): 5.645\""), "no point was told: {dom:.3000}");
    assert!(dom.contains("data-order=\"dissertation,a,b\""), "the table was not sorted");
}

#[test]
fn the_demonstration_can_be_looked_at() {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("demonstration.html");
    report().write(&path).unwrap();
    assert!(path.metadata().unwrap().len() > 10_000);
}
