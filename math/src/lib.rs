//! Textbook kernels that both simulators and learners use. Every module is named for its subject.
//!
//! Units are whatever the caller uses; angles are radians. Nothing here reads files, clocks or
//! global random state.

pub mod angle;
pub mod bordered;
pub mod cma_es;
pub mod correlation;
pub mod decomposition;
pub mod elementary;
pub mod kalman;
pub mod neighbours;
pub mod optimise;
pub mod polynomial;
pub mod quasi_newton;
pub mod random_effects;
pub mod regression;
pub mod rigid;
pub mod statistics;
pub mod tridiagonal;
pub mod wandering;
