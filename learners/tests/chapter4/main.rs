//! The learners of chapter 4 on logs whose truth is known.

mod conformance;
mod plane;
mod published;
mod synthetic;
