use super::*;
use crate::robots::aibo::Start;
use crate::robots::aibo::gait::Trot;
use crate::robots::aibo::posture::joints_rad;

/// Index of the head's pan among the joints.
const PAN: usize = 13;

/// Beyond its limits no joint goes, though the engine hears of them only where it is near.
#[test]
fn a_head_that_is_aimed_behind_itself_stops_at_its_limit() {
    let (config, blueprint) = (AiboConfig::default(), Blueprint::shipped().unwrap());
    let trot = Trot::new(config.gait.clone(), blueprint.legs.clone(), 0.0);
    let standing_rad = joints_rad(&config.head, &trot, 0.0);
    let world_from_torso = Start::default().world_from_torso(&config.gait, &blueprint, trot.pitch_rad());
    let mut body = Body::new(&config, &blueprint, &world_from_torso, &standing_rad).unwrap();
    let [least_rad, greatest_rad] = blueprint.joints[PAN].range_rad;
    let mut aimed_rad = standing_rad;
    for (aim_rad, stops_rad) in [(greatest_rad + 1.0, greatest_rad), (0.3, 0.3), (least_rad - 1.0, least_rad)] {
        // As fast as its servo goes, and a second longer.
        let step_rad = blueprint.joints[PAN].speed_rad_per_s * config.physics.time_step_s;
        let steps = (((aim_rad - aimed_rad[PAN]).abs() / step_rad) + 1.0 / config.physics.time_step_s) as usize;
        for _ in 0..steps {
            aimed_rad[PAN] += (aim_rad - aimed_rad[PAN]).clamp(-step_rad, step_rad);
            body.aim(&aimed_rad);
            body.step();
            let angle_rad = body.angle_rad(PAN);
            assert!(angle_rad > least_rad - 0.1 && angle_rad < greatest_rad + 0.1, "{aim_rad}: {angle_rad}");
        }
        assert!((body.angle_rad(PAN) - stops_rad).abs() < 0.05, "{aim_rad}: {}", body.angle_rad(PAN));
    }
}
