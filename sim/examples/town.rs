//! Builds towns and prints what they hold: triangles by detail, and how much the ranges of the lowest 16 lasers vary
//! along the route. Writes a view from above and one from the street.
//!
//! ```text
//! cargo run --example town -- out 1000 0.1 60    # folder, seed, detail, way along the route to where the view is taken
//! ```

use std::error::Error;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

use asami_dataset::Seed;
use asami_math::elementary::sin_cos;
use asami_raycast::{Caster, MeshError, Packets, Ray};
use asami_sim::scenes::town::{Surface, Town, TownConfig};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().unwrap_or_else(|| ".".to_owned());
    let seed = Seed(arguments.next().map_or(Ok(1000), |text| text.parse())?);
    let detail: f64 = arguments.next().map_or(Ok(0.1), |text| text.parse())?;
    let along_m: f64 = arguments.next().map_or(Ok(60.0), |text| text.parse())?;
    for detail in [0.0, 0.1, 0.25, 0.5, 0.75, 1.0] {
        let began = Instant::now();
        let town = Town::new(&TownConfig { detail, ..TownConfig::default() }, seed);
        let took_s = began.elapsed().as_secs_f64();
        let ground = town.ground().triangles.len();
        println!("detail {detail:4}: {:7} triangles, {ground:6} of them ground, {took_s:.2} s", town.triangles.len());
    }
    let town = Town::new(&TownConfig { detail, ..TownConfig::default() }, seed);
    println!("route {:.1} m, stops at {:.1?}", town.route.length_m(), town.route.stops_m());
    let caster = packets(&town)?;
    println!("laser  elevation  mean   sd of range, m");
    for (laser, (mean, sd)) in ranges(&town, &caster).into_iter().enumerate() {
        println!("{laser:5} {:10.2} {mean:5.2} {sd:6.3}", elevation_deg(laser));
    }
    std::fs::write(Path::new(&folder).join("town.svg"), from_above(&town)?)?;
    std::fs::write(Path::new(&folder).join("street.ppm"), from_street(&town, &caster, along_m))?;
    Ok(())
}

fn packets(town: &Town) -> Result<Packets, MeshError> {
    Packets::new(&town.vertices, &town.triangles)
}

/// Lower lasers: evenly spaced from -24.7 to -8.9 degrees (Stronger 2008, section 2.5.2).
fn elevation_deg(laser: usize) -> f64 {
    -24.7 + 0.512 * laser as f64
}

/// Range, and number of the triangle.
fn cast(caster: &Packets, from: [f64; 3], along: [f64; 3]) -> Option<(f64, usize)> {
    let ray = Ray { origin: from.map(|it| it as f32), direction: along.map(|it| it as f32) };
    let hit = caster.cast_all(&[ray], 120.0)[0]?;
    Some((f64::from(hit.range), hit.triangle as usize))
}

/// Mean and standard deviation of range, all around, every 2 m of the route, from 2 m above it.
fn ranges(town: &Town, caster: &Packets) -> Vec<(f64, f64)> {
    let eyes: Vec<[f64; 3]> =
        (0..(0.5 * town.route.length_m()) as usize).map(|i| eye(town, caster, 2.0 * i as f64)).collect();
    (0..16)
        .map(|laser| {
            let (rise, flat) = sin_cos(elevation_deg(laser).to_radians());
            let look = |(eye, azimuth): (&[f64; 3], i32)| {
                let (sin, cos) = sin_cos(f64::from(azimuth).to_radians());
                cast(caster, *eye, [flat * cos, flat * sin, rise]).map(|(range_m, _)| range_m)
            };
            let all: Vec<f64> =
                eyes.iter().flat_map(|eye| (0..360).map(move |it| (eye, it))).filter_map(look).collect();
            let mean = all.iter().sum::<f64>() / all.len() as f64;
            (mean, (all.iter().map(|it| (it - mean).powi(2)).sum::<f64>() / all.len() as f64).sqrt())
        })
        .collect()
}

fn eye(town: &Town, caster: &Packets, along_m: f64) -> [f64; 3] {
    let at = town.route.at(along_m);
    let down_m = cast(caster, [at.x_m, at.y_m, 50.0], [0.0, 0.0, -1.0]).map_or(50.0, |(range_m, _)| range_m);
    [at.x_m, at.y_m, 52.0 - down_m]
}

fn colour(surface: Surface) -> [u8; 3] {
    match surface {
        Surface::Asphalt => [96, 96, 100],
        Surface::Pavement => [170, 165, 155],
        Surface::Concrete => [200, 198, 190],
        Surface::Grass => [120, 170, 90],
        Surface::Wall => [215, 190, 160],
        Surface::Roof => [165, 80, 60],
        Surface::Glass => [120, 160, 200],
        Surface::Wood => [150, 110, 70],
        Surface::Bark => [90, 70, 50],
        Surface::Leaves => [50, 120, 50],
        Surface::Metal => [90, 110, 170],
        Surface::Rubber => [30, 30, 30],
    }
}

fn from_above(town: &Town) -> Result<String, Box<dyn Error>> {
    let mut order: Vec<usize> = (0..town.triangles.len()).collect();
    let top = |i: usize| town.triangles[i].iter().map(|&at| town.vertices[at as usize][2]).fold(f32::MIN, f32::max);
    order.sort_by(|&a, &b| top(a).total_cmp(&top(b)));
    let mut svg = String::from(
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="-230 -230 460 460" width="1150" height="1150">"#,
    );
    for i in order {
        let [r, g, b] = colour(town.surface[i]);
        let mut points = String::new();
        for at in town.triangles[i] {
            let [x, y, _] = town.vertices[at as usize];
            write!(points, "{x:.2},{:.2} ", -y)?;
        }
        write!(svg, r#"<path fill="rgb({r},{g},{b})" d="M{points}Z"/>"#)?;
    }
    let mut line = String::new();
    for step in 0..=(town.route.length_m() as usize) {
        let at = town.route.at(step as f64);
        write!(line, "{:.2},{:.2} ", at.x_m, -at.y_m)?;
    }
    write!(svg, r#"<polyline points="{line}" fill="none" stroke="yellow" stroke-width="0.5"/>"#)?;
    for at in town.route.stops() {
        write!(svg, r#"<circle cx="{:.2}" cy="{:.2}" r="1.5" fill="red"/>"#, at.x_m, -at.y_m)?;
    }
    svg.push_str("</svg>");
    Ok(svg)
}

/// What the driver sees somewhere along the route, from the height of the Velodyne.
fn from_street(town: &Town, caster: &Packets, along_m: f64) -> Vec<u8> {
    let (width, height) = (1400, 600);
    let at = town.route.at(along_m);
    let (ahead, right, eye) = (at.ahead(), at.right(), eye(town, caster, along_m));
    let mut image = format!("P6 {width} {height} 255\n").into_bytes();
    for row in 0..height {
        for column in 0..width {
            let (u, v) = ((column as f64 - 0.5 * width as f64) / 700.0, (0.45 * height as f64 - row as f64) / 700.0);
            let length = (1.0 + u * u + v * v).sqrt();
            let along = [ahead[0] + u * right[0], ahead[1] + u * right[1], v].map(|it| it / length);
            let pixel = cast(caster, eye, along).map_or([185, 210, 240], |(range_m, triangle)| {
                let [x, y, z] = normal(town, triangle);
                let light = 0.35 + 0.65 * (0.3 * x - 0.5 * y + 0.8 * z).abs();
                let haze = range_m / 250.0;
                let lit = |it: u8| (1.0 - haze) * f64::from(it) * light + haze * 200.0;
                colour(town.surface[triangle]).map(|it| lit(it) as u8)
            });
            image.extend(pixel);
        }
    }
    image
}

fn normal(town: &Town, triangle: usize) -> [f64; 3] {
    let [a, b, c] = town.triangles[triangle].map(|at| town.vertices[at as usize].map(f64::from));
    let (u, v) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = normal.iter().map(|it| it * it).sum::<f64>().sqrt();
    normal.map(|it| it / length)
}
