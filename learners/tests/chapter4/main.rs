//! The learners of chapter 4 on logs whose truth is known.

mod batch;
mod bound;
mod conformance;
mod consistency;
mod filters;
mod kernels;
mod lacking;
mod line;
mod oracle;
mod plane;
mod published;
mod symmetry;
mod synthetic;
mod variants;
