//! What each laser of a scanner is off by: `lasers.csv`.

use asami_dataset::store::number;
use asami_gap::real::scanner::lasers::Laser;

/// Columns of `lasers.csv`: the laser, counted upwards from 0; what is to be added to its vertical angle in the table, and taken away from
/// its ranges, each with its standard error; where it stands.
pub const COLUMNS: &str = "laser,vertical_rad,vertical_se_rad,range_m,range_se_m,left_m,up_m";

/// The lasers as text.
#[must_use]
pub fn csv(lasers: &[Laser]) -> String {
    let row = |(i, it): (usize, &Laser)| {
        let values = [it.vertical_rad, it.vertical_se_rad, it.range_m, it.range_se_m, it.left_m, it.up_m];
        format!("{i},{}\n", values.map(number).join(","))
    };
    format!("{COLUMNS}\n{}", lasers.iter().enumerate().map(row).collect::<String>())
}
