//! The learners of chapter 3 on logs whose truth is known.

mod algorithm1;
mod canonical;
mod conformance;
mod likelihood;
mod one_model;
mod synthetic;
