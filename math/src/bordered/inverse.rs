//! What is read off a factorised system: its determinant, solution, and the inverse where it is needed.

use crate::decomposition::cholesky_solve;

use super::blocks::{known, subtract};
use super::{Bordered, Link, STATE, Segment};

impl Bordered {
    /// Logarithm of the determinant of the matrix last factorised.
    #[must_use]
    pub fn log_det(&self) -> f64 {
        self.log_det
    }

    /// `b_c^T A^-1 b_d` for two right-hand sides.
    #[must_use]
    pub fn gram(&self, c: usize, d: usize) -> f64 {
        self.gram.get(c * self.columns + d).copied().unwrap_or(0.0)
    }

    /// Solution for the parameters, the sum of all columns.
    #[must_use]
    pub fn parameters(&self) -> Vec<f64> {
        (0..self.parameters).map(|i| self.border_solution.iter().fold(0.0, |sum, column| sum + column[i])).collect()
    }

    /// Solution for the states, the sum of all columns.
    #[must_use]
    pub fn solution(&self) -> Vec<[f64; STATE]> {
        let mut states = vec![[0.0; STATE]; self.states()];
        let parameters = self.parameters();
        let width = STATE + self.parameters + self.columns;
        let front_width = 3 * STATE + self.locals + self.columns;
        let mut next = [0.0; STATE];
        for s in (0..=self.segments.len()).rev() {
            let gain = &self.end_gain[s * STATE * width..(s + 1) * STATE * width];
            let end: [f64; STATE] = std::array::from_fn(|i| {
                let row = &gain[i * width..(i + 1) * width];
                let sides = row[STATE + self.parameters..].iter().fold(0.0, |sum, x| sum + x);
                sides - known(row, &next) - known(&row[STATE..], &parameters)
            });
            let right = std::mem::replace(&mut next, end);
            let Some(segment) = self.segments.get(s) else {
                if let Some(last) = states.last_mut() {
                    *last = end;
                }
                continue;
            };
            states[segment.first] = end;
            let local: Vec<f64> = segment.parameters.iter().map(|p| parameters[*p]).collect();
            let mut after = right;
            for t in (segment.first + 1..segment.last).rev() {
                let turn = (t - segment.first - 1) % 2 * STATE;
                let gain = &self.inner_gain[t * STATE * front_width..(t + 1) * STATE * front_width];
                after = std::array::from_fn(|i| {
                    let row = &gain[i * front_width..(i + 1) * front_width];
                    let sides = row[3 * STATE + self.locals..].iter().fold(0.0, |sum, x| sum + x);
                    sides
                        - known(&row[STATE - turn..], &after)
                        - known(&row[2 * STATE..], &end)
                        - known(&row[3 * STATE..], &local)
                });
                states[t] = after;
            }
        }
        states
    }

    /// The parameters' block of the inverse, by rows: their covariance, the states unknown too.
    #[must_use]
    pub fn border_inverse(&self) -> Vec<Vec<f64>> {
        let p = self.parameters;
        let unit = |i: usize| (0..p).map(|j| f64::from(u8::from(i == j))).collect::<Vec<f64>>();
        (0..p).map(|i| cholesky_solve(&self.border, &unit(i))).collect()
    }

    /// Visits the inverse at the unknowns of each link, from the last link to the first.
    pub fn visit_inverse(&self, mut visit: impl FnMut(usize, &Link)) {
        let (p, columns) = (self.parameters, self.columns);
        let border: Vec<f64> = self.border_inverse().concat();
        let width = STATE + p + columns;
        let (order, locals) = (3 * STATE + self.locals, self.locals);
        let mut link = Link::new(2 * STATE + locals, 0);
        let mut front = vec![0.0; order * order];
        let (mut own, mut next_own) = ([0.0; 9], [0.0; 9]);
        let (mut rows, mut next_rows) = (vec![0.0; STATE * p], vec![0.0; STATE * p]);
        for s in (0..=self.segments.len()).rev() {
            let gain = &self.end_gain[s * STATE * width..(s + 1) * STATE * width];
            let mut beside = [0.0; 9];
            for i in 0..STATE {
                let row = &gain[i * width..(i + 1) * width];
                let to = &mut rows[i * p..(i + 1) * p];
                to.fill(0.0);
                for k in 0..STATE {
                    subtract(to, row[k], &next_rows[k * p..]);
                }
                for k in 0..p {
                    subtract(to, row[STATE + k], &border[k * p..]);
                }
                for j in 0..STATE {
                    beside[i * STATE + j] = (0..STATE).fold(0.0, |sum, k| sum - row[k] * next_own[k * STATE + j])
                        - known(&row[STATE..], &next_rows[j * p..(j + 1) * p]);
                }
            }
            for i in 0..STATE {
                for j in 0..STATE {
                    let row = &gain[j * width..(j + 1) * width];
                    own[i * STATE + j] = self.end_inverse[s][i * STATE + j]
                        - known(row, &beside[i * STATE..(i + 1) * STATE])
                        - known(&row[STATE..], &rows[i * p..(i + 1) * p]);
                }
            }
            if let Some(segment) = self.segments.get(s) {
                let turn = (segment.last - segment.first - 1) % 2 * STATE;
                self.gather(&mut front, segment, turn, [&own, &next_own, &beside], [&rows, &next_rows], &border);
                self.visit_segment(s, &mut front, &mut link, &mut visit);
            }
            (next_own, own) = (own, next_own);
            std::mem::swap(&mut rows, &mut next_rows);
        }
    }

    /// The inverse at the ends and parameters of a segment, into a front.
    fn gather(
        &self,
        front: &mut [f64],
        segment: &Segment,
        right: usize,
        blocks: [&[f64; 9]; 3],
        rows: [&[f64]; 2],
        border: &[f64],
    ) {
        let (p, order) = (self.parameters, 3 * STATE + self.locals);
        let (left, local) = (2 * STATE, 3 * STATE);
        let [own, next_own, beside] = blocks;
        for i in 0..STATE {
            for j in 0..STATE {
                front[(left + i) * order + left + j] = own[i * STATE + j];
                front[(right + i) * order + right + j] = next_own[i * STATE + j];
                front[(left + i) * order + right + j] = beside[i * STATE + j];
                front[(right + j) * order + left + i] = beside[i * STATE + j];
            }
            for (j, parameter) in segment.parameters.iter().enumerate() {
                for (at, rows) in [left, right].into_iter().zip(rows) {
                    front[(at + i) * order + local + j] = rows[i * p + parameter];
                    front[(local + j) * order + at + i] = rows[i * p + parameter];
                }
            }
        }
        for (i, a) in segment.parameters.iter().enumerate() {
            for (j, b) in segment.parameters.iter().enumerate() {
                front[(local + i) * order + local + j] = border[a * p + b];
            }
        }
    }

    fn visit_segment(&self, s: usize, front: &mut [f64], link: &mut Link, visit: &mut impl FnMut(usize, &Link)) {
        let segment = &self.segments[s];
        let (order, left) = (3 * STATE + self.locals, 2 * STATE);
        let width = order + self.columns;
        for t in (segment.first..segment.last).rev() {
            // The state after `t` stands where the elimination of `t` left it.
            let (now, next) = if t == segment.first {
                (left, 0)
            } else {
                let now = (t - segment.first - 1) % 2 * STATE;
                (now, STATE - now)
            };
            if t > segment.first {
                let gain = &self.inner_gain[t * STATE * width..(t + 1) * STATE * width];
                let inverse = &self.inner_inverse[t];
                for i in 0..STATE {
                    let row = &gain[i * width..i * width + order];
                    let (before, rest) = front.split_at_mut((now + i) * order);
                    let (to, after) = rest.split_at_mut(order);
                    to.fill(0.0);
                    for k in (0..order).filter(|k| !(now..now + STATE).contains(k)) {
                        let other =
                            if k < now + i { &before[k * order..] } else { &after[(k - now - i - 1) * order..] };
                        subtract(to, row[k], other);
                    }
                    to[now..now + STATE].fill(0.0);
                }
                let mut own = [0.0; 9];
                for i in 0..STATE {
                    for j in 0..STATE {
                        let row = &gain[j * width..j * width + order];
                        own[i * STATE + j] = inverse[i * STATE + j] - known(row, &front[(now + i) * order..][..order]);
                    }
                }
                for i in 0..STATE {
                    front[(now + i) * order + now..][..STATE].copy_from_slice(&own[i * STATE..(i + 1) * STATE]);
                    for k in (0..order).filter(|k| !(now..now + STATE).contains(k)) {
                        front[k * order + now + i] = front[(now + i) * order + k];
                    }
                }
            }
            let starts = [now, next, 3 * STATE];
            for i in 0..link.rows {
                let from = (starts[(i / STATE).min(2)] + i - (i / STATE).min(2) * STATE) * order;
                let to = &mut link.entries[i * link.width..(i + 1) * link.width];
                to[..STATE].copy_from_slice(&front[from + now..][..STATE]);
                to[STATE..2 * STATE].copy_from_slice(&front[from + next..][..STATE]);
                to[2 * STATE..].copy_from_slice(&front[from + 3 * STATE..from + order]);
            }
            visit(t, link);
        }
    }
}
