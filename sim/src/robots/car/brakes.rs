//! Brakes get hot: the work that they do on turning wheels stays in them for a while.

/// Time constant with which their heat goes into the air.
const COOLING_S: f64 = 300.0;

/// The heat in all brakes together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Brakes {
    heat_j: f64,
}

impl Brakes {
    /// Share of their torque that is left, where each MJ of heat adds `fade_per_mj` to the divisor.
    #[must_use]
    pub fn left(&self, fade_per_mj: f64) -> f64 {
        1.0 / (1.0 + fade_per_mj * 1e-6 * self.heat_j)
    }

    /// Takes up one step's work of `torques_n_m` on wheels that turn as fast as `spins_rad_per_s`.
    pub fn work(&mut self, torques_n_m: &[f64; 4], spins_rad_per_s: &[f64; 4], dt_s: f64) {
        let power_w: f64 = torques_n_m.iter().zip(spins_rad_per_s).map(|(torque, spin)| torque * spin.abs()).sum();
        self.heat_j += (power_w - self.heat_j / COOLING_S) * dt_s;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Held at an even power heat approaches power times time constant; left alone it goes.
    #[test]
    fn heat_comes_with_work_and_goes_with_time() {
        let mut brakes = Brakes::default();
        for _ in 0..(6.0 * COOLING_S / 0.01) as usize {
            brakes.work(&[10.0; 4], &[-5.0; 4], 0.01);
        }
        assert!((brakes.heat_j / (200.0 * COOLING_S) - 1.0).abs() < 3e-3, "{}", brakes.heat_j);
        assert!((brakes.left(1.0 / (200.0e-6 * COOLING_S)) - 0.5).abs() < 1e-3);
        for _ in 0..(6.0 * COOLING_S / 0.01) as usize {
            brakes.work(&[10.0; 4], &[0.0; 4], 0.01);
        }
        assert!(brakes.left(1.0) > 0.999 && brakes.heat_j > 0.0);
    }
}
