//! The round through the town: straight along streets, arcs to the left at corners.

use asami_math::angle::wrap_rad;
use asami_math::elementary::sin_cos;
use std::f64::consts::FRAC_PI_2;

use super::TownConfig;

/// A place on a route.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    /// World x.
    pub x_m: f64,
    /// World y.
    pub y_m: f64,
    /// Heading, 0 facing world +y, counter-clockwise.
    pub theta_rad: f64,
    /// Of the route there; positive to the left.
    pub curvature_per_m: f64,
}

impl Waypoint {
    /// The direction of travel.
    #[must_use]
    pub fn ahead(&self) -> [f64; 2] {
        let (sin, cos) = sin_cos(self.theta_rad);
        [-sin, cos]
    }

    /// The direction to the right of it.
    #[must_use]
    pub fn right(&self) -> [f64; 2] {
        let (sin, cos) = sin_cos(self.theta_rad);
        [cos, sin]
    }
}

/// A straight piece or an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    start: Waypoint,
    from_m: f64,
    length_m: f64,
}

/// A closed way, measured from its start.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    pieces: Vec<Piece>,
    length_m: f64,
    /// Where stop lines are, in order along the way.
    stops_m: Vec<f64>,
}

impl Route {
    /// Counter-clockwise about a rectangle of streets on their right-hand side; `between` are the streets, by x and
    /// by y, that it crosses. Stop lines stand before every junction.
    pub(super) fn around([x0, y0, x1, y1]: [f64; 4], between: [&[f64]; 2], config: &TownConfig) -> Self {
        let lane_m = config.lane_m;
        let reach_m = 0.5 * config.street_width_m + config.corner_radius_m;
        let radius_m = reach_m + lane_m;
        let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
        let mut route = Self { pieces: Vec::new(), length_m: 0.0, stops_m: Vec::new() };
        for side in 0..4 {
            let (from, to) = (corners[side], corners[(side + 1) % 4]);
            let theta_rad = wrap_rad(side as f64 * FRAC_PI_2 - FRAC_PI_2);
            let heading = Waypoint { x_m: from[0], y_m: from[1], theta_rad, curvature_per_m: 0.0 };
            let (ahead, right) = (heading.ahead(), heading.right());
            let at = |along_m: f64| Waypoint {
                x_m: from[0] + along_m * ahead[0] + lane_m * right[0],
                y_m: from[1] + along_m * ahead[1] + lane_m * right[1],
                ..heading
            };
            let side_m = (to[0] - from[0]).abs() + (to[1] - from[1]).abs();
            let axis = side % 2;
            let mut crossings: Vec<f64> = between[axis].iter().map(|line| (line - from[axis]).abs()).collect();
            crossings.sort_by(f64::total_cmp);
            crossings.push(side_m);
            let begun_m = route.length_m;
            route.stops_m.extend(crossings.iter().map(|crossing| begun_m + crossing - 2.0 * reach_m));
            route.push(at(reach_m), side_m - 2.0 * reach_m);
            let arc = Waypoint { curvature_per_m: 1.0 / radius_m, ..at(side_m - reach_m) };
            route.push(arc, FRAC_PI_2 * radius_m);
        }
        route
    }

    fn push(&mut self, start: Waypoint, length_m: f64) {
        self.pieces.push(Piece { start, from_m: self.length_m, length_m });
        self.length_m += length_m;
    }

    /// All the way round.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// Stop lines along the way.
    #[must_use]
    pub fn stops_m(&self) -> &[f64] {
        &self.stops_m
    }

    /// The places of the stop lines.
    pub fn stops(&self) -> impl Iterator<Item = Waypoint> {
        self.stops_m.iter().map(|&along_m| self.at(along_m))
    }

    /// Where one is after `along_m` from the start.
    #[must_use]
    pub fn at(&self, along_m: f64) -> Waypoint {
        let along_m = along_m.rem_euclid(self.length_m);
        let after = self.pieces.partition_point(|piece| piece.from_m <= along_m);
        let piece = &self.pieces[after.saturating_sub(1)];
        let (start, ahead_m) = (piece.start, along_m - piece.from_m);
        let ahead = start.ahead();
        if start.curvature_per_m == 0.0 {
            return Waypoint { x_m: start.x_m + ahead_m * ahead[0], y_m: start.y_m + ahead_m * ahead[1], ..start };
        }
        let (radius_m, right) = (1.0 / start.curvature_per_m, start.right());
        let turned_rad = ahead_m * start.curvature_per_m;
        let (sin, cos) = sin_cos(turned_rad);
        // About the centre, which is to the left.
        let place = |axis: usize| radius_m * (sin * ahead[axis] - (1.0 - cos) * right[axis]);
        let theta_rad = wrap_rad(start.theta_rad + turned_rad);
        Waypoint { x_m: start.x_m + place(0), y_m: start.y_m + place(1), theta_rad, ..start }
    }

    /// How far along the route the place nearest to a point is, looked for within 15 m of where it last was.
    #[must_use]
    pub fn along_m(&self, [x_m, y_m]: [f64; 2], last_m: f64) -> f64 {
        const REACH_M: f64 = 15.0;
        let squared = |along_m: f64| {
            let at = self.at(along_m);
            (at.x_m - x_m) * (at.x_m - x_m) + (at.y_m - y_m) * (at.y_m - y_m)
        };
        let steps = (0..=60).map(|step| last_m - REACH_M + 0.5 * f64::from(step));
        let nearest = steps.map(|along_m| (squared(along_m), along_m)).min_by(|a, b| a.0.total_cmp(&b.0));
        let mut best_m = nearest.map_or(last_m, |(_, along_m)| along_m);
        for _ in 0..4 {
            // Along the tangent: exact on straights, quickly so on arcs.
            let at = self.at(best_m);
            let ahead = at.ahead();
            best_m += (x_m - at.x_m) * ahead[0] + (y_m - at.y_m) * ahead[1];
        }
        best_m
    }

    /// All turns together, radians to the left; a full circle, were it all driven.
    #[must_use]
    pub fn turn_rad(&self) -> f64 {
        self.pieces.iter().map(|piece| piece.length_m * piece.start.curvature_per_m).sum()
    }
}
