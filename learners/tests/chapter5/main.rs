//! The learners of chapter 5 on drives whose truth is known.

mod conformance;
mod kernels;
mod published;
mod synthetic;
mod variants;
