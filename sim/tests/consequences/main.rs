//! One consequence of each effect that no formula in its file states, so that the physics, the geometry or the
//! image must have brought it about.

mod aibo_body;
mod aibo_eye;
mod plain;
