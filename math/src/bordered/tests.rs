use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

use super::*;

const PARAMETERS: usize = 6;
const LOCALS: usize = 3;
const COLUMNS: usize = 2;

fn segments(lengths: &[usize]) -> Vec<Segment> {
    let mut first = 0;
    lengths
        .iter()
        .enumerate()
        .map(|(s, length)| {
            first += length;
            let parameters = vec![(s * 2) % PARAMETERS, (s * 2 + 1) % PARAMETERS, (s * 2 + 4) % PARAMETERS];
            Segment { first: first - length, last: first, parameters }
        })
        .collect()
}

/// Entries of link `t`, out of a fixed list of numbers: positive definite by a hair.
fn fill(numbers: &[f64], t: usize, link: &mut Link) {
    let rows = link.rows;
    let draw = |i: usize| numbers[(t * 31 + i * 7) % numbers.len()];
    for k in 0..4 {
        for i in 0..rows {
            for j in 0..rows {
                *link.at_mut(i, j) += draw(k * rows + i) * draw(k * rows + j);
            }
        }
    }
    for i in 0..rows {
        *link.at_mut(i, i) += 0.05;
        for c in 0..COLUMNS {
            *link.side_mut(i, c) += draw(100 + i + 20 * c);
        }
    }
}

/// Where the unknowns of link `t` stand among all, states first.
fn places(segments: &[Segment], t: usize, states: usize) -> Vec<usize> {
    let segment = segments.iter().find(|segment| (segment.first..segment.last).contains(&t)).unwrap();
    (STATE * t..STATE * (t + 2)).chain(segment.parameters.iter().map(|p| STATE * states + p)).collect()
}

fn dense(segments: &[Segment], numbers: &[f64], prior: &[[f64; 2]]) -> (DMatrix<f64>, DMatrix<f64>) {
    let links = segments.last().unwrap().last;
    let n = STATE * (links + 1) + PARAMETERS;
    let (mut a, mut b) = (DMatrix::zeros(n, n), DMatrix::zeros(n, COLUMNS));
    for t in 0..links {
        let mut link = Link::new(2 * STATE + LOCALS, COLUMNS);
        fill(numbers, t, &mut link);
        let at = places(segments, t, links + 1);
        for (i, row) in at.iter().enumerate() {
            for (j, column) in at.iter().enumerate() {
                a[(*row, *column)] += link.at(i, j);
            }
            for c in 0..COLUMNS {
                b[(*row, c)] += link.at(i, link.rows + c);
            }
        }
    }
    for (i, [information, side]) in prior.iter().enumerate() {
        let at = n - PARAMETERS + i;
        a[(at, at)] += information;
        b[(at, COLUMNS - 1)] += side;
    }
    (a, b)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn agrees_with_the_dense_system(
        lengths in proptest::collection::vec(1..6usize, 1..6),
        numbers in proptest::collection::vec(-1.0..1.0f64, 211),
    ) {
        let segments = segments(&lengths);
        let prior = [[0.3, -0.2], [0.1, 0.4], [0.2, 0.0], [0.5, 1.0], [0.1, 0.1], [0.7, -0.6]];
        let (a, b) = dense(&segments, &numbers, &prior);
        let mut system = Bordered::new(segments.clone(), PARAMETERS, COLUMNS).unwrap();
        // Twice: nothing is left over of what was factorised before.
        system.factorise(&[[1.0, 1.0]; PARAMETERS], |t, link| fill(&numbers[7..], t, link)).unwrap();
        system.factorise(&prior, |t, link| fill(&numbers, t, link)).unwrap();
        let inverse = a.clone().try_inverse().unwrap();
        let near = |x: f64, y: f64| (x - y).abs() < 1e-8 * (1.0 + x.abs());

        let log_det = a.cholesky().unwrap().l().diagonal().iter().map(|l| 2.0 * l.ln()).sum::<f64>();
        prop_assert!(near(log_det, system.log_det()));
        let gram = b.transpose() * &inverse * &b;
        prop_assert!((0..COLUMNS).all(|c| (0..COLUMNS).all(|d| near(gram[(c, d)], system.gram(c, d)))));

        let x: DVector<f64> = (&inverse * &b).column_sum();
        let flat: Vec<f64> = system.solution().concat().into_iter().chain(system.parameters()).collect();
        prop_assert!(x.iter().zip(&flat).all(|(x, y)| near(*x, *y)), "{x} {flat:?}");

        let (n, states) = (inverse.nrows(), system.states());
        let border = system.border_inverse();
        let m = n - PARAMETERS;
        prop_assert!((0..PARAMETERS).all(|i| (0..PARAMETERS).all(|j| near(inverse[(m + i, m + j)], border[i][j]))));
        let (mut visited, mut worst) = (Vec::new(), 0.0_f64);
        system.visit_inverse(|t, link| {
            visited.push(t);
            for (i, row) in places(&segments, t, states).into_iter().enumerate() {
                for (j, column) in places(&segments, t, states).into_iter().enumerate() {
                    let exact = inverse[(row, column)];
                    worst = worst.max((link.at(i, j) - exact).abs() / (1.0 + exact.abs()));
                }
            }
        });
        visited.reverse();
        prop_assert_eq!(visited, (0..states - 1).collect::<Vec<_>>());
        prop_assert!(worst < 1e-8, "{worst}");
    }
}

#[test]
fn refuses_what_is_no_chain_and_what_is_not_positive() {
    assert!(Bordered::new(Vec::new(), 1, 1).is_none());
    let gap = vec![Segment { first: 1, last: 2, parameters: vec![0] }];
    assert!(Bordered::new(gap, 1, 1).is_none());
    let unknown = vec![Segment { first: 0, last: 2, parameters: vec![1] }];
    assert!(Bordered::new(unknown, 1, 1).is_none());
    let mut system = Bordered::new(segments(&[2, 1]), PARAMETERS, COLUMNS).unwrap();
    assert!(system.factorise(&[[1.0, 0.0]; PARAMETERS], |_, _| ()).is_none());
    assert!(system.factorise(&[[1.0, 0.0]; PARAMETERS], |_, link| *link.at_mut(0, 0) = f64::NAN).is_none());
}
