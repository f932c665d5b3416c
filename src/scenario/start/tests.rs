use asami_dataset::{Action, Beacon, Command, Known, Sighting, Size};

use super::*;

/// Two actions, one landmark, sizes of one kind.
fn log(size: fn(f64) -> Size) -> Log {
    let command = |n: u16| {
        let action = Action::Legs {
            id: Some(7 + n % 2),
            ax_m_per_s: 0.1 * f64::from(n % 2),
            ay_m_per_s: 0.2,
            atheta_rad_per_s: -0.3,
        };
        Command { t_s: f64::from(n), action }
    };
    let see = |n: u32| Sighting { t_s: 0.1 * f64::from(n), landmark: 0, size: size(20.0), bearing_rad: 0.0 };
    let known = Known { landmarks: vec![Beacon { id: 0, x_m: 0.0, y_m: 0.0, height_m: None }], ..Known::default() };
    Log {
        known: known.into(),
        commands: (0..10).map(command).collect::<Vec<_>>().into(),
        sightings: (0..100).map(see).collect::<Vec<_>>().into(),
        ..Log::default()
    }
}

fn line(models: &Models) -> &Polynomial {
    match &models.sensor {
        Some(SensorModel::HeightOfDistance(curve) | SensorModel::RangeOfDistance(curve)) => &curve.polynomial,
        _ => panic!("a function of the distance"),
    }
}

#[test]
fn published_models_have_no_effect_and_those_attempted_do() {
    let starting = Starting::default();
    let [published, attempted] =
        [Start::Published, Start::Attempted].map(|start| starting.models(start, &log(Size::HeightPx)).unwrap());
    let Some(ActionModel::Table(zero)) = &published.action else { panic!("a table") };
    assert!(zero.iter().all(|it| [it.vx_m_per_s, it.vy_m_per_s, it.vtheta_rad_per_s] == [0.0; 3]));
    assert_eq!(zero.iter().map(|it| it.action).collect::<Vec<_>>(), [7, 8]);
    let Some(ActionModel::Table(entries)) = &attempted.action else { panic!("a table") };
    let off = |found: f64, due: f64| (found - due).abs() < 1e-12;
    assert!(off(entries[1].vx_m_per_s, 0.1) && off(entries[0].vx_m_per_s, 0.0), "{entries:?}");
    assert!(entries.iter().all(|it| off(it.vy_m_per_s, 0.2) && off(it.vtheta_rad_per_s, -0.3)));
    // Section 4.4.1: 10 px, 0.2 rad; 10 mm, 10 mm, 0.1 rad a step.
    let noise =
        Noise { sigma1_px: Some(10.0), sigma2_rad: Some(0.2), motion_sd: Some([0.01, 0.01, 0.1]), ..Noise::default() };
    assert_eq!((published.noise, attempted.noise), (noise, noise));
}

#[test]
fn worse_starts_turn_about_their_middle_and_flatten() {
    let starting = Starting::default();
    let starts = [Start::Published, Start::FWorse1, Start::FWorse2, Start::FWorse3];
    let slopes = starts.map(|start| {
        let models = starting.models(start, &log(Size::HeightPx)).unwrap();
        assert!((line(&models).at(starting.mid_m) - starting.f_mid_px).abs() < 1e-12);
        line(&models).slope_at(1.0)
    });
    assert!((slopes[0] + starting.f_fall_px_per_m).abs() < 1e-12);
    assert!(slopes.windows(2).all(|pair| pair[0] < pair[1]), "{slopes:?}");
}

#[test]
fn only_the_motions_noise_is_halved_or_doubled() {
    let starting = Starting::default();
    for (start, factor) in [(Start::SigmaMHalf, 0.5), (Start::SigmaMDouble, 2.0)] {
        let models = starting.models(start, &log(Size::HeightPx)).unwrap();
        let published = starting.models(Start::Published, &log(Size::HeightPx)).unwrap();
        assert_eq!(models.noise.motion_sd, published.noise.motion_sd.map(|sd| sd.map(|sd| factor * sd)));
        assert_eq!((models.sensor, models.action), (published.sensor, published.action));
    }
}

#[test]
fn ranges_start_from_a_line_of_their_own() {
    let models = Starting::default().models(Start::Published, &log(Size::RangeM)).unwrap();
    assert!(matches!(models.sensor, Some(SensorModel::RangeOfDistance(_))));
    assert!(models.noise.sigma1_m.is_some() && models.noise.sigma1_px.is_none());
    assert!(line(&models).slope_at(1.0) > 0.0);
}

#[test]
fn names_in_files_are_names_in_tables() {
    for start in Start::CHAPTER_4.into_iter().chain([
        Start::C,
        Start::Sgn,
        Start::One,
        Start::ReferenceCubic,
        Start::ReferenceCar,
        Start::HalfCar,
    ]) {
        assert_eq!(serde_json::to_value(start).unwrap(), start.name());
    }
}
