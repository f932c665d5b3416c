//! Broken data sets: every one gives an error that names the file and the rule, or is valid after
//! all; none panics.

use std::collections::BTreeMap;
use std::path::Path;

use asami_dataset::{Rng, Seed, store};
use rand::RngExt;

type Set = &'static [(&'static str, &'static str)];
type Files = BTreeMap<&'static str, Vec<u8>>;

const AIBO: Set = &[
    (
        "dataset.toml",
        "schema = 1\nrobot = \"aibo\"\nnominal = \"aibo_1d\"\ncommand_rate_hz = 20.0\n\n[camera]\nwidth_px = 208\n\
         height_px = 160\nfocal_px = 191.943\nframe_rate_hz = 30.0\n\n[[landmarks]]\nid = 0\nx_m = -1.8\ny_m = 2.7\n\
         height_m = 0.2\n\n[[landmarks]]\nid = 4\nx_m = 1.8\ny_m = 2.7\nheight_m = 0.2\n\n[provenance]\n\
         scenario = \"aibo_1d\"\nscenario_hash = \"blake3:00\"\nseed = 7\nversion = \"0.1.0\"\n",
    ),
    (
        "commands.csv",
        "t_s,action,ax_m_per_s,ay_m_per_s,atheta_rad_per_s\n0.0,,0.0,0.21,0.01\n3.0,12,0.0,-0.1,0.0\n6.0,,0.0,0.3,-0.02\n",
    ),
    ("frames.csv", "t_s,head_pan_rad\n0.05,0.0\n0.1,0.2\n0.15,0.4\n0.2,-3.1\n"),
    (
        "sightings.csv",
        "t_s,landmark,height_px,bearing_rad\n0.05,0,21.5,0.1\n0.1,0,21.25,-0.1\n0.1,4,12.0,0.5\n0.2,0,22.0,-3.0\n",
    ),
    ("truth.csv", "t_s,x_m,y_m,theta_rad,v_m_per_s\n0.0,0.0,0.0,0.0,0.2\n0.1,0.0,0.02,0.001,\n0.2,0.0,0.04,0.0,0.2\n"),
    (
        "survey.toml",
        "schema = 1\nspeed_by_command = [{ command_m_per_s = 0.3, speed_m_per_s = 0.22, sd_m_per_s = 0.004, timings = 5 }]\n\
         height_by_distance = [{ distance_m = 1.2, height_px = 31.2, sd_px = 1.0, bearing_sd_rad = 0.02, readings = 100 }]\n\
         velocity_by_action = [{ action = 0, vx_m_per_s = 0.0, vy_m_per_s = 0.2, vtheta_rad_per_s = 0.1 }]\n\
         sigma1_px = 1.6\nsigma2_rad = 0.027\nmotion_sd = [0.01, 0.01, 0.1]\nhorizontal_angles_rad = [0.0]\ntheta_b_rad = 1.5551\n",
    ),
];

const CREATE: Set = &[
    (
        "dataset.toml",
        "schema = 1\nrobot = \"create\"\n[range_bearing]\nmax_range_m = 5.0\nsensor_origin_m = [0.0, 0.219016]\n\
         [[landmarks]]\nid = 1\nx_m = 1.0\ny_m = 2.0\n",
    ),
    ("commands.csv", "t_s,v_m_per_s,omega_rad_per_s\n0.0,0.1,0.0\n0.1,0.2,0.0\n"),
    ("sightings.csv", "t_s,landmark,range_m,bearing_rad\n0.1,1,2.5,0.1\n0.2,1,2.4,0.1\n"),
];

const CAR: Set = &[
    (
        "dataset.toml",
        "schema = 1\nrobot = \"car\"\n[velodyne]\nvertical_angles_rad = [-0.4311, 0.03]\nfiring_rate_hz = 7800.0\n\
         turn_rate_hz = 10.0\nsensor_height_m = 2.0\n[full_scale]\nthrottle_percent = 100.0\n",
    ),
    ("commands.csv", "t_s,throttle,brake,steering\n0.0,0.1,0.0,-0.3\n0.05,1.0,0.0,0.3\n"),
    ("odometry.csv", "t_s,v_m_per_s,omega_rad_per_s\n0.0,1.0,0.0\n0.05,1.1,0.1\n"),
];

const MODELS: &str = "schema = 1\nlearner = \"em_published\"\n[action]\nkind = \"table\"\n\
    entries = [{ action = 0, vx_m_per_s = 0.0, vy_m_per_s = 0.21, vtheta_rad_per_s = 0.1, se = [0.004, 0.004, 0.01] }]\n\
    [sensor]\nkind = \"height_of_distance\"\ncoefficients = [30.1, -8.2, 2.0, -0.3]\ncentre = 2.4\nscale = 1.2\n\
    se = [0.02, 0.02, 0.03, 0.02]\n[noise]\nsigma1_px = 1.62\nsigma2_rad = 0.026\n\
    motion_sd = [0.01, 0.01, 0.1]\nsigma1_se = 0.02\nsigma2_rad_se = 0.001\nmotion_sd_se = [0.001, 0.001, 0.01]\n";

fn files(of: Set) -> Files {
    of.iter().map(|(name, text)| (*name, text.as_bytes().to_vec())).collect()
}

fn put(files: &Files, dir: &Path) {
    for (name, bytes) in files {
        std::fs::write(dir.join(name), bytes).unwrap();
    }
}

/// Reads the files out of a fresh folder.
fn read(files: &Files) -> Result<asami_dataset::Dataset, store::ReadError> {
    let dir = tempfile::tempdir().unwrap();
    put(files, dir.path());
    store::read(dir.path())
}

#[test]
fn the_sound_ones_are_read() {
    for sound in [AIBO, CREATE, CAR] {
        read(&files(sound)).unwrap();
    }
    let aibo = read(&files(AIBO)).unwrap();
    assert_eq!(aibo.log.commands[0].action.forward_m_per_s(), Some(0.21));
    assert_eq!(aibo.log.sightings[2].landmark, 4);
    assert_eq!(aibo.truth.track[1].v_m_per_s, None);
    assert_eq!(aibo.provenance.unwrap().seed, 7);
}

/// Each with the file and place that the error must name, and words of its rule and value.
#[test]
fn every_rule_names_file_line_column_and_value() {
    #[rustfmt::skip]
    let cases: &[(Set, &'static str, &str, &str, &str)] = &[
        (AIBO, "dataset.toml", "schema = 1", "schema = 2", "dataset.toml:1:10: schema must be 1, not 2"),
        (AIBO, "dataset.toml", "schema = 1", "schema = \"1\"", "dataset.toml:1:10: schema must be 1, not \"1\""),
        (AIBO, "dataset.toml", "schema = 1\n", "", "a key schema must be given"),
        (AIBO, "dataset.toml", "\"aibo\"", "\"cat\"", "dataset.toml:2:9: robot must be one of \"aibo\""),
        (
            CREATE,
            "dataset.toml",
            "[range_bearing]",
            "commands_are = \"wished\"\n[range_bearing]",
            "dataset.toml:3:16: commands_are must be \"told\" or \"odometry\"",
        ),
        (AIBO, "dataset.toml", "robot = \"aibo\"\n", "", "a key robot must be given"),
        (AIBO, "dataset.toml", "nominal", "nominel", "dataset.toml:3:1: unknown key nominel (keys: schema, robot, nominal"),
        (AIBO, "dataset.toml", "focal_px", "focal", "a key focal_px must be given"),
        (AIBO, "dataset.toml", "191.943", "nan", "dataset.toml:9:12: focal_px must be a number greater than 0, not nan"),
        (AIBO, "dataset.toml", "191.943", "-191.943", "focal_px must be a number greater than 0, not -191.943"),
        (AIBO, "dataset.toml", "191.943", "1e999", "not 1e999"),
        (AIBO, "dataset.toml", "191.943", "\"wide\"", "not \"wide\""),
        (AIBO, "dataset.toml", "width_px = 208", "width_px = 208.5", "width_px must be a whole number in 1..=4294967295, not 208.5"),
        (AIBO, "dataset.toml", "id = 4", "id = 65536", "id must be a whole number in 0..=65535, not 65536"),
        (AIBO, "dataset.toml", "id = 4", "id = 0", "landmark ids must differ from one another: 0 stands twice"),
        (AIBO, "dataset.toml", "x_m = 1.8", "x_m = inf", "x_m must be a finite number, not inf"),
        (AIBO, "dataset.toml", "x_m = 1.8", "x_m = 1.8\nz_m = 0.0", "unknown key z_m"),
        (AIBO, "dataset.toml", "seed = 7", "seed = -7", "dataset.toml:27:8: seed must be a whole number"),
        (AIBO, "dataset.toml", "[camera]", "[[camera]]", "camera must be a table, not a list"),
        (AIBO, "dataset.toml", "[camera]", "[camera", "dataset.toml:6:"),
        (AIBO, "dataset.toml", "[camera]", "[range_bearing]\nmax_range_m = 1.0\nsensor_origin_m = [0.0, 0.0]\n[camera]", "sightings must be heights or ranges, not both"),
        (CREATE, "dataset.toml", "[0.0, 0.219016]", "[0.0]", "sensor_origin_m must have 2 values, not 1"),
        (CREATE, "dataset.toml", "[0.0, 0.219016]", "0.2", "sensor_origin_m must be a list of numbers, not 0.2"),
        (CAR, "dataset.toml", "[-0.4311, 0.03]", "[0.03, -0.4311]", "vertical_angles_rad must increase from laser to laser"),
        (CAR, "dataset.toml", "[-0.4311, 0.03]", "[]", "vertical_angles_rad must have 1 to 64 values, not 0"),
        (CAR, "dataset.toml", "firing_rate_hz", "left_m = [0.0]\nfiring_rate_hz", "left_m must have 2, as there are lasers, or no values, not 1"),
        (CAR, "dataset.toml", "firing_rate_hz", "up_m = [inf, 0.0]\nfiring_rate_hz", "up_m must be a finite number, not inf"),
        (CAR, "dataset.toml", "[-0.4311, 0.03]", "[-25.0]", "must be an angle in [-pi/2, pi/2], not -25.0"),
        (CAR, "dataset.toml", "percent = 100.0", "percent = 0.0", "throttle_percent must be a number greater than 0"),
        (AIBO, "commands.csv", "ay_m_per_s,", "", "commands.csv:1:1: the header must have a column ay_m_per_s"),
        (AIBO, "commands.csv", "ay_m_per_s,", "ax_m_per_s,", "commands.csv:1:23: column ax_m_per_s must not stand twice"),
        (AIBO, "commands.csv", "ay_m_per_s,", "ay_mm_per_s,", "commands.csv:1:23: unknown column ay_mm_per_s"),
        (AIBO, "commands.csv", "3.0,12", "-3.0,12", "commands.csv:3:1: times must increase: -3 follows 0"),
        (AIBO, "commands.csv", "6.0,", "3.0,", "commands.csv:4:1: times must increase: 3 follows 3"),
        (AIBO, "commands.csv", "0.21", "NaN", "commands.csv:2:10: ay_m_per_s must be a finite number, not NaN"),
        (AIBO, "commands.csv", "0.21", "inf", "not inf"),
        (AIBO, "commands.csv", "0.21", "", "ay_m_per_s must be a finite number, not an empty field"),
        (AIBO, "commands.csv", "0.21", "0,21", "commands.csv:2:1: a row must have as many fields as the header, 5, not 6"),
        (AIBO, "commands.csv", "0.21", " 0.21", "not  0.21"),
        (AIBO, "commands.csv", ",12,", ",70000,", "commands.csv:3:5: action must be a whole number in 0..=65535, not 70000"),
        (AIBO, "commands.csv", ",12,", ",-1,", "action must be a whole number"),
        (AIBO, "commands.csv", ",12,", ",1.5,", "action must be a whole number"),
        (AIBO, "commands.csv", "\n3.0", "\n\n3.0", "commands.csv:3:1: a line must not be blank"),
        (AIBO, "commands.csv", "-0.02\n", "-0.02", "commands.csv:4:1: must end in a line break"),
        (AIBO, "commands.csv", "t_s,action", "\u{feff}t_s,action", "must not begin with a byte order mark"),
        (CAR, "commands.csv", "1.0", "1.5", "commands.csv:3:6: throttle must be a number in 0..=1, not 1.5"),
        (CAR, "commands.csv", "-0.3", "-1.3", "steering must be a number in -1..=1, not -1.3"),
        (CREATE, "dataset.toml", "\"create\"", "\"car\"", "commands.csv:1:5: unknown column v_m_per_s (columns: t_s,throttle"),
        (CREATE, "commands.csv", "t_s,v_m_per_s,omega_rad_per_s\n0.0,", "t_s,action,v_m_per_s,omega_rad_per_s\n0.0,x,", "commands.csv:2:5: action must be a whole number in 0..=65535, not x"),
        (AIBO, "frames.csv", "-3.1", "3.1416", "frames.csv:5:5: head_pan_rad must be an angle in [-pi, pi), not 3.1416"),
        (AIBO, "frames.csv", "0.15", "0.05", "times must increase: 0.05 follows 0.1"),
        (AIBO, "sightings.csv", ",4,", ",5,", "sightings.csv:4:5: landmark must be one that dataset.toml declares, not 5"),
        (AIBO, "sightings.csv", "12.0", "-12.0", "sightings.csv:4:7: height_px must be a number greater than 0, not -12.0"),
        (AIBO, "sightings.csv", "0.2,0", "0.09,0", "times must not decrease: 0.09 follows 0.1"),
        (AIBO, "sightings.csv", "-3.0", "-3.2", "bearing_rad must be an angle in [-pi, pi), not -3.2"),
        (AIBO, "sightings.csv", "bearing_rad", "range_m", "sightings must be heights or ranges, not both"),
        (AIBO, "sightings.csv", "height_px", "range_m", "sightings must be heights: dataset.toml has [camera]"),
        (CREATE, "sightings.csv", "range_m", "height_px", "sightings must be ranges: dataset.toml has [range_bearing]"),
        (CREATE, "sightings.csv", "2.5", "0.0", "range_m must be a number greater than 0"),
        (AIBO, "truth.csv", "0.001", "6.3", "truth.csv:3:14: theta_rad must be an angle in [-pi, pi), not 6.3"),
        (AIBO, "truth.csv", "v_m_per_s", "v (m/s)", "unknown column v (m/s)"),
        (AIBO, "survey.toml", "timings = 5", "timings = 0", "timings must be a whole number in 1..=4294967295, not 0"),
        (AIBO, "survey.toml", "sd_px = 1.0", "sd_px = -1.0", "survey.toml:3:69: sd_px must be a number not less than 0, not -1.0"),
        (AIBO, "survey.toml", "sigma1_px", "sigma_px", "unknown key sigma_px"),
        (AIBO, "survey.toml", "action = 0", "action = 0x10", "action must be a whole number"),
        (AIBO, "survey.toml", "[0.0]", "[[0.0]]", "horizontal_angles_rad must be a finite number, not a list"),
    ];
    for (set, file, from, to, expected) in cases {
        let mut files = files(set);
        let text = String::from_utf8(files[file].clone()).unwrap();
        assert!(text.contains(from), "{file}: {from}");
        files.insert(file, text.replacen(from, to, 1).into_bytes());
        let error = read(&files).expect_err(expected).to_string();
        assert!(error.contains(expected), "\nwanted: {expected}\nfound:  {error}");
    }
}

#[test]
fn broken_models_name_the_place() {
    let cases = [
        ("learner = \"em_published\"\n", "", "a key learner must be given"),
        ("\"table\"", "\"tabel\"", "models.toml:4:8: kind must be one of \"polynomial\""),
        ("\"table\"", "\"polynomial\"", "a key coefficients must be given"),
        ("[0.004, 0.004, 0.01]", "[0.004, 0.004]", "se must have 3 values, not 2"),
        ("[0.02, 0.02, 0.03, 0.02]", "[0.02]", "se must have 4 values, not 1"),
        ("[30.1, -8.2, 2.0, -0.3]", "[]", "coefficients must have 1 to 64 values, not 0"),
        ("scale = 1.2", "scale = 0.0", "scale must not be 0"),
        ("[noise]", "[nose]", "unknown key nose (keys: schema, learner, action, sensor, noise)"),
        ("centre = 2.4", "center = 2.4", "unknown key center"),
        ("1.62", "-1.62", "sigma1_px must be a number not less than 0, not -1.62"),
    ];
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("models.toml");
    std::fs::write(&path, MODELS).unwrap();
    assert_eq!(store::read_models(&path).unwrap().0, "em_published");
    for (from, to, expected) in cases {
        std::fs::write(&path, MODELS.replacen(from, to, 1)).unwrap();
        let error = store::read_models(&path).expect_err(expected).to_string();
        assert!(error.contains(expected), "\nwanted: {expected}\nfound:  {error}");
    }
}

#[test]
fn what_is_no_file_or_too_long_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let missing = store::read(dir.path()).unwrap_err().to_string();
    assert!(missing.contains("dataset.toml: the file must be there"), "{missing}");
    put(&files(AIBO), dir.path());

    let frames = dir.path().join("frames.csv");
    std::fs::write(&frames, [b"t_s,head_pan_rad\n0.1,0.".to_vec(), vec![b'0'; 1 << 20], b"\n".to_vec()].concat())
        .unwrap();
    let long = store::read(dir.path()).unwrap_err().to_string();
    assert!(long.contains("frames.csv:2:1: a line must not be longer than 4096 bytes"), "{long}");
    std::fs::write(&frames, b"t_s,head_pan_rad\n0.1,\xff\n").unwrap();
    let bytes = store::read(dir.path()).unwrap_err().to_string();
    assert!(bytes.contains("frames.csv:2:5: must be UTF-8"), "{bytes}");
    std::fs::remove_file(&frames).unwrap();
    std::fs::create_dir(&frames).unwrap();
    let folder = store::read(dir.path()).unwrap_err().to_string();
    assert!(folder.contains("frames.csv: must be a regular file"), "{folder}");
    std::fs::remove_dir(&frames).unwrap();

    std::fs::write(dir.path().join("survey.toml"), vec![b'#'; 5 << 20]).unwrap();
    let large = store::read(dir.path()).unwrap_err().to_string();
    assert!(large.contains("survey.toml: must not be longer than 4194304 bytes"), "{large}");
    let nested = format!("schema = 1\nhorizontal_angles_rad = {}", "[".repeat(100_000));
    std::fs::write(dir.path().join("survey.toml"), nested).unwrap();
    store::read(dir.path()).unwrap_err();
}

/// One random injury to one file.
fn injure(bytes: &mut Vec<u8>, rng: &mut Rng) {
    let at = |rng: &mut Rng, len: usize| rng.random_range(0..len.max(1));
    let mut lines: Vec<Vec<u8>> = bytes.split_inclusive(|b| *b == b'\n').map(<[u8]>::to_vec).collect();
    match rng.random_range(0..10) {
        0 => drop(lines.remove(at(rng, lines.len()))),
        1 => {
            let line = lines[at(rng, lines.len())].clone();
            lines.insert(at(rng, lines.len()), line);
        }
        2 => {
            let (a, b) = (at(rng, lines.len()), at(rng, lines.len()));
            lines.swap(a, b);
        }
        3 => {
            // Two neighbouring fields of one line change places.
            let line = &mut lines[at(rng, bytes.len()) % bytes.iter().filter(|b| **b == b'\n').count().max(1)];
            let mut fields: Vec<&[u8]> = line.split(|b| *b == b',').collect();
            let i = at(rng, fields.len());
            let j = (i + 1) % fields.len();
            fields.swap(i, j);
            *line = fields.join(&b',');
        }
        4 => {
            let whole = lines.concat();
            lines = vec![whole[..at(rng, whole.len())].to_vec()];
        }
        5 => {
            let mut whole = lines.concat();
            let i = at(rng, whole.len());
            whole[i] = rng.random();
            lines = vec![whole];
        }
        6 => {
            let mut whole = lines.concat();
            whole.remove(at(rng, whole.len()));
            lines = vec![whole];
        }
        7 => {
            let mut whole = lines.concat();
            let i = at(rng, whole.len());
            const JUNK: [&[u8]; 8] = [b"nan", b"-inf", b"1e400", b",", b"\n", b"\"", b"99999999999999999999", b"\0"];
            let junk = JUNK[at(rng, JUNK.len())];
            whole.splice(i..i, junk.iter().copied());
            lines = vec![whole];
        }
        8 => {
            // A digit becomes another, a point a comma.
            let mut whole = lines.concat();
            let digits: Vec<usize> =
                (0..whole.len()).filter(|i| whole[*i].is_ascii_digit() || whole[*i] == b'.').collect();
            let i = digits[at(rng, digits.len())];
            whole[i] = if whole[i] == b'.' { b',' } else { b'0' + rng.random_range(0..10u8) };
            lines = vec![whole];
        }
        _ => {
            let line = &mut lines[rng.random_range(0..3) % 3];
            line.insert(0, b'-');
        }
    }
    *bytes = lines.concat();
}

#[test]
fn injured_data_sets_give_an_error_with_its_place_or_are_sound() {
    let mut rng = Seed(2).stream("broken");
    let (mut refused, mut sound) = (0, 0);
    for round in 0..1200 {
        let mut files = files([AIBO, CREATE, CAR][round % 3]);
        let names: Vec<&'static str> = files.keys().copied().collect();
        let name = names[rng.random_range(0..names.len())];
        for _ in 0..=round % 2 {
            let bytes = files.get_mut(name).unwrap();
            if bytes.iter().filter(|b| **b == b'\n').count() >= 3 {
                injure(bytes, &mut rng);
            }
        }
        match read(&files) {
            Err(error) => {
                refused += 1;
                assert!(files.keys().any(|name| error.file.ends_with(name)), "{error}");
                assert!(error.place.is_some(), "{error}");
                assert!(error.to_string().len() < 1000, "{error}");
            }
            // Sound is what can be written again and reads the same.
            Ok(dataset) => {
                sound += 1;
                let dir = tempfile::tempdir().unwrap();
                store::write(&dataset, dir.path()).unwrap();
                assert_eq!(store::read(dir.path()).unwrap(), dataset);
            }
        }
    }
    assert!(refused >= 600 && sound >= 100, "{refused} refused, {sound} sound");
}
