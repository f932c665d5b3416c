//! Symmetric positive definite systems of a chain of small states with a border of parameters common to
//! all: the normal equations of a trajectory whose models are unknown.
//!
//! State `t` is coupled with its neighbours and, between two changes of action, with a few of the
//! parameters only. Each such segment is condensed onto its two ends and those few, all ends onto the
//! parameters (Schur complements; Triggs et al. 2000, "Bundle Adjustment: A Modern Synthesis", section 6).
//! Time grows with the number of states, not with the number of parameters. The inverse is had at
//! the entries where the matrix itself is not zero (Takahashi et al. 1973).

mod blocks;
mod inverse;
#[cfg(test)]
mod tests;

use crate::decomposition::{cholesky, cholesky_solve, dot};
use crate::elementary::ln;

use blocks::{add, add_gram, combine, inverse_of, reduce_border, subtract};

/// Unknowns of one state.
pub const STATE: usize = 3;

/// Links `first..last` between the states `first..=last`, all of which know the same few parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// First link: between the states `first` and `first + 1`.
    pub first: usize,
    /// One past the last link.
    pub last: usize,
    /// The parameters, without repetition; as many in every segment.
    pub parameters: Vec<usize>,
}

/// A symmetric matrix over the unknowns of a link, in the order state `t`, state `t + 1`, the segment's
/// parameters, and beside it right-hand sides.
#[derive(Clone, Debug)]
pub struct Link {
    /// Number of rows.
    pub rows: usize,
    /// Entries in a row: the matrix's, then the right-hand sides'.
    pub width: usize,
    /// By rows.
    pub entries: Vec<f64>,
}

impl Link {
    fn new(rows: usize, columns: usize) -> Self {
        Self { rows, width: rows + columns, entries: vec![0.0; rows * (rows + columns)] }
    }

    /// Entry in row `i` and column `j`.
    #[must_use]
    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.entries[i * self.width + j]
    }

    /// The same, to be changed.
    pub fn at_mut(&mut self, i: usize, j: usize) -> &mut f64 {
        &mut self.entries[i * self.width + j]
    }

    /// The right-hand side `column` in row `i`, to be changed.
    pub fn side_mut(&mut self, i: usize, column: usize) -> &mut f64 {
        &mut self.entries[i * self.width + self.rows + column]
    }
}

/// The system under elimination; its buffers serve again for the next matrix of the same form.
#[derive(Clone, Debug)]
pub struct Bordered {
    segments: Vec<Segment>,
    parameters: usize,
    locals: usize,
    columns: usize,
    link: Link,
    /// One segment under elimination: two states by turns, the segment's left end, its parameters; then the sides.
    front: Vec<f64>,
    /// Of each state inside a segment: `pivot^-1` times its rows of the front.
    inner_gain: Vec<f64>,
    inner_inverse: Vec<[f64; 9]>,
    /// Of each end of a segment: `pivot^-1` times its coupling to the next end, to all parameters, and its sides.
    end_gain: Vec<f64>,
    end_inverse: Vec<[f64; 9]>,
    /// Cholesky's factor of what is left for the parameters.
    border: Vec<Vec<f64>>,
    /// Solutions for the parameters, one row a column.
    border_solution: Vec<Vec<f64>>,
    /// `b^T A^-1 b` of all pairs of right-hand sides.
    gram: Vec<f64>,
    log_det: f64,
}

impl Bordered {
    /// A system of this form: segments in order, each beginning where the last one ended, the first at
    /// link 0. `None` if they do not.
    #[must_use]
    pub fn new(segments: Vec<Segment>, parameters: usize, columns: usize) -> Option<Self> {
        let locals = segments.first()?.parameters.len();
        let mut end = 0;
        for segment in &segments {
            let known = segment.parameters.iter().all(|p| *p < parameters);
            if segment.first != end || segment.last <= end || segment.parameters.len() != locals || !known {
                return None;
            }
            end = segment.last;
        }
        let front = 3 * STATE + locals;
        Some(Self {
            parameters,
            locals,
            columns,
            link: Link::new(2 * STATE + locals, columns),
            front: vec![0.0; front * (front + columns)],
            inner_gain: vec![0.0; (end + 1) * STATE * (front + columns)],
            inner_inverse: vec![[0.0; 9]; end + 1],
            end_gain: vec![0.0; (segments.len() + 1) * STATE * (STATE + parameters + columns)],
            end_inverse: vec![[0.0; 9]; segments.len() + 1],
            border: Vec::new(),
            border_solution: Vec::new(),
            gram: vec![0.0; columns * columns],
            log_det: 0.0,
            segments,
        })
    }

    /// Number of states.
    #[must_use]
    pub fn states(&self) -> usize {
        self.segments.last().map_or(0, |segment| segment.last + 1)
    }

    /// Factorises the sum of all links and of a `prior` on the parameters (information, and its right-hand
    /// side in the last column), and solves for the parameters. `fill` adds what link `t` brings to a matrix of zeros.
    /// `None` where the sum is not positive definite.
    pub fn factorise(&mut self, prior: &[[f64; 2]], mut fill: impl FnMut(usize, &mut Link)) -> Option<()> {
        let (p, width) = (self.parameters, self.parameters + self.columns);
        self.log_det = 0.0;
        self.gram.fill(0.0);
        let mut border = vec![0.0; p * width];
        for (i, [information, side]) in prior.iter().enumerate().take(p) {
            border[i * width + i] = *information;
            if self.columns > 0 {
                border[i * width + width - 1] = *side;
            }
        }
        let end_width = STATE + width;
        // Rows of an end: its own block, then parameters and sides.
        let (mut own, mut next_own) = ([0.0; 9], [0.0; 9]);
        let (mut rows, mut next_rows) = (vec![0.0; STATE * width], vec![0.0; STATE * width]);
        for s in 0..self.segments.len() {
            let right = self.condense(s, &mut fill)?;
            let mut beside = [0.0; 9];
            self.spread(s, right, [&mut own, &mut next_own, &mut beside], [&mut rows, &mut next_rows], &mut border);
            let inverse = self.pivot(&own)?;
            self.end_inverse[s] = inverse;
            let gain = &mut self.end_gain[s * STATE * end_width..(s + 1) * STATE * end_width];
            for i in 0..STATE {
                for j in 0..STATE {
                    gain[i * end_width + j] =
                        (0..STATE).fold(0.0, |sum, k| sum + inverse[i * STATE + k] * beside[k * STATE + j]);
                }
                combine(&mut gain[i * end_width + STATE..(i + 1) * end_width], &inverse[i * STATE..], &rows, width);
            }
            for i in 0..STATE {
                for k in 0..STATE {
                    let b = beside[k * STATE + i];
                    subtract(&mut next_own[i * STATE..(i + 1) * STATE], b, &gain[k * end_width..]);
                    subtract(&mut next_rows[i * width..(i + 1) * width], b, &gain[k * end_width + STATE..]);
                }
            }
            reduce_border(&mut border, &rows, &gain[STATE..], end_width, p, width);
            add_gram(&mut self.gram, &rows[p..], width, &gain[STATE + p..], end_width, self.columns);
            (own, next_own) = (next_own, [0.0; 9]);
            std::mem::swap(&mut rows, &mut next_rows);
            next_rows.fill(0.0);
        }
        let last = self.segments.len();
        let inverse = self.pivot(&own)?;
        self.end_inverse[last] = inverse;
        let gain = &mut self.end_gain[last * STATE * end_width..];
        for i in 0..STATE {
            gain[i * end_width..i * end_width + STATE].fill(0.0);
            combine(&mut gain[i * end_width + STATE..(i + 1) * end_width], &inverse[i * STATE..], &rows, width);
        }
        reduce_border(&mut border, &rows, &gain[STATE..], end_width, p, width);
        add_gram(&mut self.gram, &rows[p..], width, &gain[STATE + p..], end_width, self.columns);
        self.solve_border(&border)
    }

    fn solve_border(&mut self, border: &[f64]) -> Option<()> {
        let (p, width) = (self.parameters, self.parameters + self.columns);
        // Only the upper triangle was kept up to date.
        let symmetric: Vec<Vec<f64>> =
            (0..p).map(|i| (0..p).map(|j| border[i.min(j) * width + i.max(j)]).collect()).collect();
        self.border = cholesky(&symmetric)?;
        for (i, row) in self.border.iter().enumerate() {
            self.log_det += 2.0 * ln(row[i]);
        }
        let sides: Vec<Vec<f64>> =
            (0..self.columns).map(|c| (0..p).map(|i| border[i * width + p + c]).collect()).collect();
        self.border_solution = sides.iter().map(|side| cholesky_solve(&self.border, side)).collect();
        let pairs = sides.iter().flat_map(|side| self.border_solution.iter().map(move |solution| dot(side, solution)));
        for (gram, pair) in self.gram.iter_mut().zip(pairs) {
            *gram += pair;
        }
        Some(())
    }

    /// Eliminates the states inside segment `s`; says which turn of the front its right end has.
    fn condense(&mut self, s: usize, fill: &mut impl FnMut(usize, &mut Link)) -> Option<usize> {
        let (first, last) = (self.segments[s].first, self.segments[s].last);
        let order = 3 * STATE + self.locals;
        let width = order + self.columns;
        self.front.fill(0.0);
        let mut turn = 0;
        for t in first..last {
            self.link.entries.fill(0.0);
            fill(t, &mut self.link);
            // Where the link's unknowns stand in the front.
            let now = if t == first { 2 * STATE } else { turn * STATE };
            let next = if t == first { 0 } else { (1 - turn) * STATE };
            let place = |block: usize| match block {
                0 => now,
                1 => next,
                _ => 3 * STATE,
            };
            let starts = [0, STATE, 2 * STATE, self.link.rows];
            for a in 0..3 {
                for i in starts[a]..starts[a + 1] {
                    let to = (place(a) + i - starts[a]) * width;
                    let row = &self.link.entries[i * self.link.width..(i + 1) * self.link.width];
                    add(&mut self.front[to + now..to + now + STATE], &row[..STATE]);
                    add(&mut self.front[to + next..to + next + STATE], &row[STATE..2 * STATE]);
                    add(&mut self.front[to + 3 * STATE..to + width], &row[2 * STATE..]);
                }
            }
            if t > first {
                self.eliminate(t, turn * STATE, order, width)?;
                turn = 1 - turn;
            }
        }
        Some(turn)
    }

    /// Eliminates state `t`, which stands at `at` in the front.
    fn eliminate(&mut self, t: usize, at: usize, order: usize, width: usize) -> Option<()> {
        let mut own = [0.0; 9];
        for i in 0..STATE {
            own[i * STATE..(i + 1) * STATE].copy_from_slice(&self.front[(at + i) * width + at..][..STATE]);
        }
        let inverse = self.pivot(&own)?;
        self.inner_inverse[t] = inverse;
        let gain = &mut self.inner_gain[t * STATE * width..(t + 1) * STATE * width];
        let rows = &self.front[at * width..(at + STATE) * width];
        for i in 0..STATE {
            combine(&mut gain[i * width..(i + 1) * width], &inverse[i * STATE..], rows, width);
        }
        add_gram(&mut self.gram, &rows[order..], width, &gain[order..], width, self.columns);
        let (g0, rest) = gain.split_at(width);
        let (g1, g2) = rest.split_at(width);
        for i in (0..order).filter(|i| !(at..at + STATE).contains(i)) {
            let row = &mut self.front[i * width..(i + 1) * width];
            let (a, b, c) = (row[at], row[at + 1], row[at + 2]);
            if (a, b, c) == (0.0, 0.0, 0.0) {
                continue;
            }
            for (((x, g0), g1), g2) in row.iter_mut().zip(g0).zip(g1).zip(g2) {
                *x -= a * g0 + b * g1 + c * g2;
            }
            row[at..at + STATE].fill(0.0);
        }
        self.front[at * width..(at + STATE) * width].fill(0.0);
        Some(())
    }

    /// Adds what a condensed segment brings: to its ends, left and right, to what is between, and to the border.
    fn spread(&self, s: usize, turn: usize, blocks: [&mut [f64; 9]; 3], rows: [&mut [f64]; 2], border: &mut [f64]) {
        let (p, width) = (self.parameters, self.parameters + self.columns);
        let front_width = 3 * STATE + self.locals + self.columns;
        let (right, left, local) = (turn * STATE, 2 * STATE, 3 * STATE);
        let parameters = &self.segments[s].parameters;
        let at = |i: usize, j: usize| self.front[i * front_width + j];
        let [own, next_own, beside] = blocks;
        for i in 0..STATE {
            for j in 0..STATE {
                own[i * STATE + j] += at(left + i, left + j);
                next_own[i * STATE + j] += at(right + i, right + j);
                beside[i * STATE + j] += at(left + i, right + j);
            }
        }
        for (to, from) in rows.into_iter().zip([left, right]) {
            for i in 0..STATE {
                for (j, parameter) in parameters.iter().enumerate() {
                    to[i * width + parameter] += at(from + i, local + j);
                }
                add(
                    &mut to[i * width + p..(i + 1) * width],
                    &self.front[(from + i) * front_width + local + self.locals..],
                );
            }
        }
        for (i, a) in parameters.iter().enumerate() {
            for (j, b) in parameters.iter().enumerate().filter(|(_, b)| *b >= a) {
                border[a * width + b] += at(local + i, local + j);
            }
            add(
                &mut border[a * width + p..(a + 1) * width],
                &self.front[(local + i) * front_width + local + self.locals..],
            );
        }
    }

    fn pivot(&mut self, own: &[f64; 9]) -> Option<[f64; 9]> {
        let (inverse, log_det) = inverse_of(own)?;
        self.log_det += log_det;
        Some(inverse)
    }
}
